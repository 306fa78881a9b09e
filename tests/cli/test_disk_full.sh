#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A disk that is full from any write on, or at that one alone: an error with words, under final names nothing but whole files, and
# the same command afterwards makes the same files. Four places of each command; all of them where FOILGAUGE_TEST_LONG is set.
# The station has its own (test_station_robust.sh).
. tests/support/cli.sh
shim=$(dirname "$program")/tests/libfull_disk.so
if ldd "$program" | grep libasan >/dev/null || [ ! -e "$shim" ]; then
  echo "skipped: nothing is preloaded before a sanitizer"
  exit 77
fi

# at_writes NAME COMMAND...: it writes into out/.
at_writes() {
  local name=$1 total stride at once code file tried=0
  shift
  rm -rf out whole && mkdir out
  LD_PRELOAD=$shim FOILGAUGE_FULL_AT=0 "$@" >/dev/null 2>said || fail "$name: $(cat said)"
  total=$(sed -n 's/^writes: //p' said)
  [ "$total" -gt 1 ] || fail "$name: $total writes"
  mv out whole
  stride=$((total / 4 + 1))
  [ -z "${FOILGAUGE_TEST_LONG-}" ] || stride=1
  for ((at = 1; at <= total; at += stride)); do
    for once in "" FOILGAUGE_FULL_ONCE=1; do
      mkdir out
      code=0
      env LD_PRELOAD="$shim" FOILGAUGE_FULL_AT=$at $once "$@" >/dev/null 2>said || code=$?
      [ $code = 74 ] || fail "$name: write $at of $total $once: exit code $code: $(head -n 2 said)"
      grep -q '^foilgauge: .*No space left on device' said || fail "$name: write $at of $total $once: no words: $(head -n 2 said)"
      while read -r file; do
        # Records of a lot are added one by one, in the order in which scans are done: those that are there are whole.
        [[ $file = *.jsonl ]] && ! grep -qvxFf "whole/$file" "out/$file" && continue
        cmp -s "out/$file" "whole/$file" || fail "$name: write $at of $total $once leaves $file"
      done < <(cd out && find . -type f)
      "$@" >/dev/null 2>said || fail "$name: once more after write $at of $total $once: $(head -n 2 said)"
      diff -r out whole >difference || fail "$name: once more after write $at of $total $once: $(head -n 2 difference)"
      rm -rf out
      tried=$((tried + 1))
    done
  done
  echo "$name: $tried failures over $total writes"
}

cat >spec.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{"rotate_deg": -90, "design": {"bump_count": 3}}], "scanner": {"dpi": 600}}
SPEC
cat >design.json <<'DESIGN'
{"schema": "foilgauge/design/1", "name": "a", "bump_count": 3, "calibration": "not needed: the scan is rendered"}
DESIGN
mkdir scans
"$renderer" render spec.json -o scans/1.png
sed 's/: 3,/: 4,/' spec.json >other.json
"$renderer" render other.json -o scans/2.png
python3 -c 'print("y,x,run"); [print("%.3f,%d,%d" % (2 * x + 0.1 * (x * 7 % 5), x, x + 1)) for x in range(12)]' >table.csv

at_writes measure "$program" measure scans/1.png --design design.json -o out/a.json --csv out/a.csv --html out/a.html --points out/p.csv
at_writes render "$program" render spec.json -o out/scan.png --truth out/truth.json
at_writes doe "$program" doe table.csv --response y --model '1 + x' -o out/doe.json --html out/doe.html
at_writes loop "$program" loop --table table.csv --response y --model '1 + x' -o out/loop.json --html out/loop.html
at_writes lot "$program" lot scans --design design.json -o out/lot --resume
exit $failed
