#!/usr/bin/env bash
# Shards of an experiment, merged, equal the single run byte for byte.
#   experiment_shards.sh slurm|parallel NOCTULE_EXPERIMENT SOURCE_DIR
# slurm: a job array on a Slurm of its own (munged, slurmctld and slurmd on this host alone, gone afterwards).
# parallel: GNU parallel. Ends with 77, skipped, where that is not installed.
set -euo pipefail
how=$1 program=$2 source=$3
export NOCTULE_EXPERIMENT=$program
skip() { echo "skipped: $*"; exit 77; }

dir=$(mktemp -d)
daemons=()
finish() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  wait
  rm -rf "$dir"
}
trap finish EXIT

# Short: one loop, few particles.
experiment=$source/config/experiments/heptagon.yaml
options=(--seeds 1-6 --set 'scenarios[0].config.world.path.loops=1' --set 'filters[0].parameters.N=[5, 10]')

start_slurm() {
  for tool in munged slurmctld slurmd sbatch sinfo; do
    command -v "$tool" >/dev/null || PATH=$PATH:/usr/sbin:/sbin command -v "$tool" >/dev/null ||
      skip "$tool is not installed (Debian: apt install slurm-wlm munge)"
  done
  export PATH=$PATH:/usr/sbin:/sbin
  local host user port
  host=$(hostname -s) user=$(id -un) port=$((20000 + RANDOM))
  mkdir -p "$dir"/{munge,state,spool}
  chmod 700 "$dir/munge"
  (umask 077 && head -c 1024 /dev/urandom >"$dir/munge/key")
  cat >"$dir/slurm.conf" <<CONF
ClusterName=noctule
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES State=UP
CONF
  export SLURM_CONF=$dir/slurm.conf
  munged --force --foreground --key-file="$dir/munge/key" --socket="$dir/munge/socket" --pid-file="$dir/munge/pid" \
    --log-file="$dir/munge/log" --seed-file="$dir/munge/seed" >"$dir/munged.log" 2>&1 &
  daemons+=($!)
  for _ in $(seq 100); do [ -S "$dir/munge/socket" ] && break; sleep 0.1; done
  slurmctld -D >"$dir/slurmctld.log" 2>&1 &
  daemons+=($!)
  slurmd -D >"$dir/slurmd.log" 2>&1 &
  daemons+=($!)
  for _ in $(seq 60); do
    [ "$(timeout 5 sinfo --noheader --format=%t 2>/dev/null)" = idle ] && return
    sleep 0.5
  done
  tail -n 5 "$dir"/{munged,slurmctld,slurmd}.log
  skip "Slurm is installed but does not start here"
}

case $how in
  slurm)
    start_slurm
    # Tasks from 3, as a user may number them.
    timeout 240 sbatch --wait --array=3-5 --chdir="$dir" --output="$dir/task-%a.log" \
      "$source/scripts/experiment.sbatch" "$experiment" "$dir/out" "${options[@]}" ||
      { tail -n 5 "$dir"/task-*.log "$dir"/slurm*.log; exit 1; }
    ;;
  parallel)
    command -v parallel >/dev/null || skip "GNU parallel is not installed (Debian: apt install parallel)"
    parallel --quote "$program" run "$experiment" "${options[@]}" --shard {}/3 --out "$dir/out/shard-{}" ::: 0 1 2
    ;;
  *) echo "expected slurm or parallel, got '$how'"; exit 2 ;;
esac
ls -d "$dir"/out/shard-*
"$program" merge "$experiment" "${options[@]}" "$dir"/out/shard-* --out "$dir/merged"
"$program" run "$experiment" "${options[@]}" --out "$dir/single"
for table in runs.csv summary.csv series.csv; do cmp "$dir/merged/$table" "$dir/single/$table"; done
[ "$(wc -l <"$dir/single/runs.csv")" -gt 100 ]
echo "merged shards equal the single run"
