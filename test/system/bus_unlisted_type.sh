#!/usr/bin/env bash
# A .lcm file that nobody listed fails the configure step by name. Usage: bus_unlisted_type.sh SOURCE_DIR CMAKE
set -euo pipefail
source_dir=$1 cmake=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$source_dir/types" "$source_dir/cmake" "$work"
cat >"$work/CMakeLists.txt" <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(types LANGUAGES CXX)
list(APPEND CMAKE_MODULE_PATH ${PROJECT_SOURCE_DIR}/cmake)
add_subdirectory(types)
TEXT
"$cmake" -G Ninja -S "$work" -B "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; echo "the listed types alone must configure"; exit 1; }
printf 'package noctule;\nstruct stray { int64_t utime; }\n' >"$work/types/stray.lcm"
if "$cmake" -G Ninja -S "$work" -B "$work/build" >"$work/log" 2>&1; then
  echo "an unlisted type was accepted"
  exit 1
fi
grep -q 'not in the list of types in CMakeLists.txt: *stray.lcm' <(tr -s '\n ' ' ' <"$work/log") || { cat "$work/log"; exit 1; }
