#!/usr/bin/env python3
"""Python's message classes read the golden log and write the same bytes. Usage: bus_python.py PYTHON_DIR LOG"""
import struct
import sys

SYNC = 0xEDA1DA01
TYPES = {
    "ODOMETRY": "odometry", "ULTRASONIC_SCAN": "ultrasonic_scan", "LANDMARK_DETECTIONS": "landmark_detections",
    "GROUND_TRUTH": "ground_truth", "CONTOUR_FEATURES": "contour_features", "SLAM_ESTIMATE": "slam_estimate",
    "SLAM_PATH": "path_estimate", "SLAM_PARTICLES": "particles", "SLAM_MAP": "landmark_map",
    "CONTOUR_MAP": "contour_map", "CAMERA_IMAGE": "camera_image",
}


def events(path):
    with open(path, "rb") as log:
        while header := log.read(28):
            sync, _, utime, channel_size, data_size = struct.unpack(">IqqII", header)
            assert sync == SYNC
            yield utime, log.read(channel_size).decode(), log.read(data_size)


def main(python_dir, log):
    sys.path.insert(0, python_dir)
    import noctule

    seen = set()
    for utime, channel, data in events(log):
        message = getattr(noctule, TYPES[channel]).decode(data)
        assert message.utime == utime, channel
        assert message.frame in ("base_link", "map", "camera_optical"), channel
        assert message.encode() == data, channel
        seen.add(channel)
    assert seen == set(TYPES), seen
    print(f"{len(seen)} types decoded and encoded")


main(*sys.argv[1:])
