#!/usr/bin/env bash
# noctule-spy in a virtual display lists every channel and can decode every message; bytes that are no message it says
# it cannot. Usage: spy.sh SOURCE_DIR BIN_DIR SENDER
#   every_type   a publisher of every type, and of bytes that are none
#   pipeline     noctule-pipeline with its mirror, run after run: its channels, without those of a camera
set -euo pipefail
source_dir=$1 bin=$2 sender=$3
channels=$(sed -nE 's/^\| ([A-Z_]+) \| ([a-z_]+) \|.*/\1 \2/p' "$source_dir/types/CHANNELS.md")
[ "$sender" = every_type ] || channels=$(grep -vE '^(LANDMARK_DETECTIONS|CAMERA_IMAGE) ' <<<"$channels")

skip() { echo "skipped: $*"; exit 77; }
for tool in java xvfb-run; do command -v $tool >/dev/null || skip "$tool is not installed"; done
[ -f "$bin/../noctule-types.jar" ] || skip "noctule-types.jar was not built (default-jre, liblcm-java)"
[ -f /usr/share/java/jchart2d.jar ] || skip "jchart2d.jar is not installed (libjchart2d-java)"
modules=$(java --list-modules)
for module in java.desktop jdk.compiler jdk.jartool; do
  grep -q "^$module@" <<<"$modules" || skip "this Java has no module $module"
done

work=$(mktemp -d)
groups=()  # each program below leads a process group of its own: xvfb-run does not end its children
finish() {
  for group in "${groups[@]}"; do kill -- "-$group" 2>/dev/null || true; done
  # A pipeline that is told to end still writes its results.
  for _ in $(seq 100); do
    alive=0
    for group in "${groups[@]}"; do ! kill -0 -- "-$group" 2>/dev/null || alive=1; done
    [ $alive -eq 1 ] || break
    sleep 0.1
  done
  for group in "${groups[@]}"; do kill -KILL -- "-$group" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap finish EXIT

java -m jdk.compiler/com.sun.tools.javac.Main -d "$work/classes" "$source_dir/test/system/SpyProbe.java"
echo 'Premain-Class: SpyProbe' >"$work/manifest"
java -m jdk.jartool/sun.tools.jar.Main -cfm "$work/probe.jar" "$work/manifest" -C "$work/classes" .

# A port of our own, never LCM's 7667.
port=$((20000 + RANDOM % 20000))
while grep -qi ":$(printf %04X $port) " /proc/net/udp; do port=$((port + 1)); done
url="udpm://239.255.76.67:$port?ttl=0"

case "$sender" in
  every_type) command=("$bin/bus_publisher" "$url") ;;
  pipeline)
    pipeline() {
      while "$bin/noctule-pipeline" "$source_dir/config/pipelines/heptagon.yaml" --mirror "$url" --speed 100 \
        --log-level error --out "$work/run"; do :; done
    }
    export -f pipeline
    export bin source_dir work url
    command=(bash -c pipeline)
    ;;
esac
setsid "${command[@]}" 2>"$work/publisher.log" &
groups+=($!)
JAVA_TOOL_OPTIONS="-javaagent:$work/probe.jar=$work/table" \
  TMPDIR=$work setsid xvfb-run -a --server-args='-screen 0 1280x800x24' "$bin/noctule-spy" --bus "$url" >"$work/spy.log" 2>&1 &
groups+=($!)

# Rows of the table with enough messages: channel, type, "undecodable" where any was. The table's columns are channel,
# type, messages, Hz, 1/Hz, jitter, bandwidth, undecodable.
least=$([ "$sender" = every_type ] && echo 3 || echo 1)  # a pipeline draws some maps but once
shown() {
  [ -f "$work/table" ] || return 0
  awk -F'\t' -v least="$least" '$3 >= least { print $1 " " $2 ($8 > 0 ? " undecodable" : "") }' "$work/table" | LC_ALL=C sort
}
expected() { LC_ALL=C sort <<<"$channels"; }
all=$(wc -l <<<"$channels")
[ "$sender" = pipeline ] || all=$((all + 1))  # and NOT_A_TYPE
for _ in $(seq 120); do
  if ! kill -0 "${groups[0]}" 2>/dev/null; then
    cat "$work/publisher.log"
    if grep -q 'cannot multicast' "$work/publisher.log"; then skip "no multicast on this host"; fi
    exit 1
  fi
  kill -0 "${groups[1]}" 2>/dev/null || { cat "$work/spy.log"; echo "noctule-spy ended"; exit 1; }
  [ "$(shown | wc -l)" -lt $all ] || break
  sleep 0.5
done
[ -z "${NOCTULE_SPY_PICTURE:-}" ] || cp "$work/table.png" "$NOCTULE_SPY_PICTURE"
cat "$work/table" 2>/dev/null || { cat "$work/spy.log"; echo "no window came up"; exit 1; }

diff <(expected) <(shown | sed '/^NOT_A_TYPE /d') || { echo "lcm-spy shows other channels or types (>) than CHANNELS.md (<)"; exit 1; }
[ "$sender" = pipeline ] || shown | grep -qE '^NOT_A_TYPE .* undecodable$' || { echo "bytes that are no message were not found undecodable"; exit 1; }
echo "every channel is listed, none undecodable"
