#!/usr/bin/env bash
# Of the corpus of a target, what is worth committing beside the inputs to begin with: at most so many inputs and bytes, the
# smallest first, each for what it reaches that those before do not. `fuzz/distil.sh TARGET...`
set -euo pipefail
cd "$(dirname "$0")"
most_inputs=150 most_bytes=60000

binaries=${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
for target in "$@"; do
  small=$work/$target
  mkdir "$small"
  # A merge goes by size and keeps what adds features.
  if ! "$binaries/$target" -merge=1 "$small" "corpus/$target" >"$work/log" 2>&1; then
    tail -20 "$work/log"
    echo "$target: FAILED"
    exit 1
  fi
  mkdir -p "seeds/$target"
  count=0 bytes=0
  # One for each of 256 classes of size would favour none; every so many of the list in its order of size reach far and wide.
  mapfile -t files < <(find "$small" -type f -size -3k -printf '%s %p\n' | sort -n | cut -d' ' -f2)
  step=$(((${#files[@]} + most_inputs - 1) / most_inputs))
  for ((i = 0; i < ${#files[@]}; i += step)); do
    size=$(stat -c %s "${files[i]}")
    if ((bytes + size > most_bytes)); then break; fi
    cp "${files[i]}" "seeds/$target/"
    count=$((count + 1)) bytes=$((bytes + size))
  done
  echo "$target: $count inputs, $bytes bytes"
done
