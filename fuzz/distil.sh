#!/usr/bin/env bash
# Of the corpus of a target, what is worth committing: at most 150 inputs and 90 kB beside what was written by hand, the
# smallest first, each for what it reaches that those before do not. `fuzz/distil.sh TARGET...`
set -euo pipefail
cd "$(dirname "$0")"

binaries=${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release
export ASAN_OPTIONS=detect_odr_violation=0:detect_leaks=0
for target in "$@"; do
  small=$(mktemp -d)
  # A merge goes by size and keeps what adds features.
  "$binaries/$target" -merge=1 "$small" "corpus/$target" >/dev/null 2>&1
  mkdir -p "seeds/$target"
  count=0 bytes=0
  # One for each of 256 classes of size would favour none; every so many of the list in its order of size reach far and wide.
  mapfile -t files < <(find "$small" -type f -size -3k -printf '%s %p\n' | sort -n | cut -d' ' -f2)
  step=$(((${#files[@]} + 149) / 150))
  for ((i = 0; i < ${#files[@]}; i += step)); do
    size=$(stat -c %s "${files[i]}")
    if ((bytes + size > 60000)); then break; fi
    cp "${files[i]}" "seeds/$target/"
    count=$((count + 1)) bytes=$((bytes + size))
  done
  rm -r "$small"
  echo "$target: $count inputs, $bytes bytes"
done
