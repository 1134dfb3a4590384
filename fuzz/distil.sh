#!/usr/bin/env bash
# Of the corpus of a target, what is worth committing: beside the inputs with a name, the few that together reach most. `fuzz/distil.sh TARGET...`
# Each in turn is the input that reaches the most features beyond those so far for the time it takes, three of four of them one with contacts
# if there are such: inputs that are changed at random take about as long as the committed ones. Slow inputs have to find their way by a name.
# None takes longer than UMBRA_MOST_MICROSECONDS (1500): `work` with its 1,000 bodies needs 20000, and
# `scene` 2500 for some with contacts.
set -euo pipefail
cd "$(dirname "$0")"
most_inputs=25 most_size=1024 most_microseconds=${UMBRA_MOST_MICROSECONDS:-1500}

binaries=${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
# Touching manifolds, time and path of each file.
for folder in corpus seeds; do
  mkdir "$work/$folder"
  for target in "$@"; do ln -s "$PWD/$folder/$target" "$work/$folder"; done
  UMBRA_CORPUS=$work/$folder cargo test --manifest-path ../Cargo.toml --release --all-features --test corpus -- --nocapture ticks_and_contacts |
    sed -n "s|^[0-9]* \([0-9]*\) [0-9]* \([0-9]*\) $work/|\1 \2 $work/|p" >>"$work/tallies"
done
for target in "$@"; do
  mkdir "$work/small" "$work/chosen" "$work/named" "$work/fast"
  find "seeds/$target" -type f -regextype egrep -not -regex '.*/[0-9a-f]{40}' -exec cp -t "$work/named" {} +
  awk -v file="/$target/[^/]*$" -v most="$most_microseconds" '$3 ~ file && $2 <= most { print $1, $2, $3 }' "$work/tallies" |
    while read -r contacts microseconds file; do
      if [ -e "$work/named/${file##*/}" ] || [ "$(stat -c %s "$file")" -gt "$most_size" ]; then continue; fi
      # What is known of a file goes into its name.
      cp "$file" "$work/fast/$contacts-$microseconds-$(sha1sum "$file" | cut -d' ' -f1)"
    done
  if [ -z "$(find "$work/named" "$work/fast" -type f)" ]; then
    echo "$target: FAILED, no input takes at most $most_microseconds us"
    exit 1
  fi
  # The control file lists the features of each file.
  if ! "$binaries/$target" -set_cover_merge=1 "-merge_control_file=$work/control" "$work/small" "$work/named" "$work/fast" >"$work/log" 2>&1; then
    tail -20 "$work/log"
    echo "$target: FAILED"
    exit 1
  fi
  awk -v most="$most_inputs" '
    FNR == 1 { files = $1; next }
    FNR == 2 { next }
    FNR <= files + 2 { name[FNR - 3] = $0; next }
    $1 != "FT" { next }
    # Eight features of an edge tell how often it is taken.
    function reach(feature) { is_reached[feature] = is_edge[int(feature / 8)] = 1 }
    name[$2] ~ /\/named\// { count += 1; for (i = 3; i <= NF; i++) reach($i); next }
    {
      split(substr(name[$2], match(name[$2], /[^\/]*$/)), known, "-")
      if (known[1] >= 2) touches[$2] = any_touches = 1
      cost[$2] = 1000 + known[2]
      features[$2] = $0
      gain[$2] = 5 * NF
    }
    END {
      while (count < most) {
        # A gain only falls: the largest one is the largest of all if it is counted anew.
        do {
          best = ""
          for (file in gain) {
            is_open = !any_touches || count % 4 == 0 || file in touches
            if (is_open && (best == "" || gain[file] > gain[best])) best = file
          }
          if (best == "" && !any_touches) exit
          if (best == "") {
            # None with contacts is left.
            any_touches = is_new = 0
            continue
          }
          is_new = counted[best] == count + 1
          fresh = 0
          length_of = split(features[best], list)
          for (i = 3; i <= length_of; i++) if (!(list[i] in is_reached)) fresh += int(list[i] / 8) in is_edge ? 1 : 5
          gain[best] = fresh / cost[best]
          counted[best] = count + 1
          if (fresh == 0) delete gain[best]
        } while (!is_new)
        for (i = 3; i <= length_of; i++) reach(list[i])
        delete gain[best]
        count += 1
        print name[best]
      }
    }' "$work/control" | while read -r file; do
    cp "$file" "$work/chosen/${file##*-}"
  done
  find "seeds/$target" -type f -regextype egrep -regex '.*/[0-9a-f]{40}' -delete
  find "$work/chosen" -type f -exec cp -t "seeds/$target" {} +
  echo "$target: $(find "seeds/$target" -type f | wc -l) inputs, $(find "seeds/$target" -type f -exec cat {} + | wc -c) bytes"
  rm -r "$work/small" "$work/chosen" "$work/named" "$work/fast" "$work/control"
done
