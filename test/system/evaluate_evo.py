"""Trajectory errors of noctule-evaluate against evo on generated trajectories. Usage: evaluate_evo.py NOCTULE_EVALUATE"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from evo.core import metrics, sync
from evo.tools import file_interface

TOLERANCE = 1e-9
evaluate = sys.argv[1]
worst = 0.0
failures = 0
compared = 0


def quaternion(axis_angle):
    angle = np.linalg.norm(axis_angle)
    axis = axis_angle / angle if angle > 0 else axis_angle
    return np.append(axis * np.sin(angle / 2), np.cos(angle / 2))


def write(path, times, positions, turns):
    with open(path, "w") as out:
        for t, p, w in zip(times, positions, turns):
            out.write(" ".join(["%.6f" % t] + ["%.17g" % v for v in (*p, *quaternion(w))]) + "\n")


def generate(folder, seed, planar):
    """Truth at 50 Hz; estimates at 10 Hz, turned, shifted and noisy, with gaps and times a little beside the truth's."""
    random = np.random.default_rng(seed)
    t = 1000.0 + np.arange(3001) * 0.02
    s = t - t[0]
    p = np.c_[8 * np.sin(0.11 * s), 5 * np.cos(0.07 * s), 0 * s if planar else 0.5 * np.sin(0.3 * s)]
    w = np.c_[0 * s if planar else 0.2 * np.sin(0.2 * s), 0 * s if planar else 0.1 * np.cos(0.3 * s), 0.5 * np.sin(0.1 * s)]
    write(folder / "truth.tum", t, p, w)
    keep = np.arange(0, 3001, 5)
    keep = keep[(keep < 900) | (keep > 1100)]
    turn = 0.4
    r = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    noise = 0.05 * random.standard_normal((len(keep), 3)) + 0.02 * random.standard_normal((len(keep), 3)).cumsum(axis=0)
    if planar:
        noise[:, 2] = 0.0
    turned = w[keep] + np.array([0, 0, turn]) + 0.01 * random.standard_normal((len(keep), 3)) * [not planar, not planar, 1]
    offsets = np.round(random.uniform(-0.004, 0.004, len(keep)), 6)
    write(folder / "estimate.tum", t[keep] + offsets, 1.07 * (p[keep] @ r.T) + [3, -2, 0] + noise, turned)


def ours(folder, *options):
    out = subprocess.run(
        [evaluate, folder / "estimate.tum", folder / "truth.tum", "--associate", "nearest", "--json", "-", *options],
        check=True, capture_output=True, text=True).stdout
    return {m["name"]: m["value"] for m in json.loads(out)}


def compare(label, theirs, mine):
    global worst, failures, compared
    difference = abs(theirs - mine)
    worst = max(worst, difference)
    compared += 1
    if not difference <= TOLERANCE:
        failures += 1
        print(f"{label}: evo {theirs!r}, noctule-evaluate {mine!r}, difference {difference:.3g}")


def compare_statistics(label, metric, mine, name, scale=1.0):
    for ours_name, evo_name in (("rmse", "rmse"), ("mean", "mean"), ("median", "median"), ("sd", "std"),
                                ("min", "min"), ("max", "max")):
        theirs = metric.get_statistic(metrics.StatisticsType[evo_name]) * scale
        compare(f"{label} {name}_{ours_name}", theirs, mine[f"{name}_{ours_name}"])


def check(folder, label):
    truth = file_interface.read_tum_trajectory_file(str(folder / "truth.tum"))
    estimate = file_interface.read_tum_trajectory_file(str(folder / "estimate.tum"))
    truth, estimate = sync.associate_trajectories(truth, estimate, max_diff=0.01)
    for align in ("none", "se3", "sim3"):
        moved = copy.deepcopy(estimate)
        if align != "none":
            moved.align(truth, correct_scale=align == "sim3")
        mine = ours(folder, "--align", align)
        compare(f"{label} {align} poses", truth.num_poses, mine["poses"])
        for relation, name in ((metrics.PoseRelation.translation_part, "ate"),
                               (metrics.PoseRelation.rotation_angle_rad, "ate_rotation")):
            ape = metrics.APE(relation)
            ape.process_data((truth, moved))
            compare_statistics(f"{label} {align}", ape, mine, name)
    # Relative errors, with ways as truly driven: by poses (one step is 0.1 s but for the gap), by way one after the other, by way from everywhere.
    for unit, delta, all_pairs, options, name in (
            (metrics.Unit.frames, 1, False, ("--rpe-steps", "1", "--segments", "end_to_end"), "rpe_1steps"),
            (metrics.Unit.frames, 10, False, ("--rpe-steps", "10", "--segments", "end_to_end"), "rpe_10steps"),
            (metrics.Unit.frames, 10, True, ("--rpe-steps", "10"), "rpe_10steps"),
            (metrics.Unit.meters, 2, False, ("--rpe-length", "2", "--segments", "end_to_end"), "rpe_2m"),
            (metrics.Unit.meters, 2, True, ("--rpe-length", "2", "--segments", "nearest"), "rpe_2m"),
            (metrics.Unit.meters, 5, True, ("--rpe-length", "5", "--segments", "nearest"), "rpe_5m")):
        mine = ours(folder, *options)
        for relation, part in ((metrics.PoseRelation.translation_part, "translation"),
                               (metrics.PoseRelation.rotation_angle_rad, "rotation")):
            rpe = metrics.RPE(relation, delta=delta, delta_unit=unit, all_pairs=all_pairs, pairs_from_reference=True)
            rpe.process_data((truth, estimate))
            compare_statistics(f"{label} {unit.value} {delta} all_pairs={all_pairs}", rpe, mine, f"{name}_{part}")


for seed in range(1, 4):
    for planar in (True, False):
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            generate(folder, seed, planar)
            check(folder, f"seed {seed}, {'in the plane' if planar else 'in space'}:")
print(f"{compared} figures compared, largest difference {worst:.3g}, {failures} above {TOLERANCE}")
sys.exit(1 if failures or not compared else 0)
