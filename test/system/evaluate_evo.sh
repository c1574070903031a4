#!/usr/bin/env bash
# Trajectory errors of noctule-evaluate against the Python package evo, to 1e-9. Usage: evaluate_evo.sh NOCTULE_EVALUATE
python=${NOCTULE_EVO_PYTHON:-python3}
if ! "$python" -c 'import evo' 2>/dev/null; then
  echo "skipped: $python has no package evo (python3 -m venv DIR; DIR/bin/pip install evo; NOCTULE_EVO_PYTHON=DIR/bin/python)"
  exit 77
fi
exec "$python" "$(dirname "$0")/evaluate_evo.py" "$1"
