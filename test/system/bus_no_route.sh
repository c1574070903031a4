#!/usr/bin/env bash
# On a host without a multicast route the bus says so in one line with the command that mends it, and exits with code 2;
# after that command it works. Usage: bus_no_route.sh BIN_DIR
set -euo pipefail
bin=$1
if [ "${2:-}" != inside ]; then
  for tool in unshare ip timeout; do command -v $tool >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }; done
  flags=-n
  [ "$(id -u)" -eq 0 ] || flags=-rn
  unshare $flags true 2>/dev/null || { echo "skipped: network namespaces are not permitted here"; exit 77; }
  exec unshare $flags "$0" "$bin" inside
fi

url=udpm://239.255.76.67:7701
status=0
message=$("$bin/bus_publisher" $url 2>&1) || status=$?
echo "$message"
[ $status -eq 2 ] || { echo "expected exit code 2, got $status"; exit 1; }
[ "$(wc -l <<<"$message")" -eq 1 ] || { echo "expected one line"; exit 1; }
command=$(sed -nE 's/.*loopback interface: (sudo .*)$/\1/p' <<<"$message")
[ -n "$command" ] || { echo "expected the command that mends it"; exit 1; }

bash -ec "${command//sudo /}"
timeout 2 "$bin/bus_publisher" $url && status=0 || status=$?
[ $status -eq 124 ] || { echo "expected the bus to work after: $command"; exit 1; }
echo "mended by: $command"
