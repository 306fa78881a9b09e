#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# No output of any command takes the place of an input, or of another output, however it is spelled.
. "$(dirname "$0")/../support/loop.sh"
skip_when_slow # every command is refused before it measures
mkdir in lots

cat >in/spec.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{}], "scanner": {"dpi": 1200}}
SPEC
"$renderer" render in/spec.json -o in/scan.png || fail "render"
(cat in/scan.png && echo 2) >in/other.png # another scan
printf 'T,D,y\n' >in/runs.csv
for i in 1 2 3 4 5 6 7 8 9 10; do echo "$((i % 3)),$((i % 2)),$((i * i % 7)).$i" >>in/runs.csv; done
printf 'T,scan\n1,scan.png\n2,other.png\n' >in/sheet.csv
"$program" design -o in/design.full && python3 - <<'PY'
import json
json.dump(json.load(open("in/design.full"))["design"], open("in/design.json", "w"))
PY
rm -f in/design.full
echo '{"response": "y", "model": "1 + T + D"}' >in/declared.json
"$program" loop in/scan.png --model-out in/model.json || fail "loop --model-out"
"$program" loop --table in/runs.csv --declared in/declared.json --model-out in/better.json || fail "loop --table"
printf 'scan\nscan.png\n' >in/list.csv
"$program" lot --print-recipe >in/recipe.json || fail "lot --print-recipe"
sums() { (cd "$1" && find . -type f ! -name .lock -exec sha256sum {} + | sort -k 2); }
sums in >sums

# Spellings of the file in/$1 that hide nothing.
ln -s in linked
spell() {
  case $(($2 % 4)) in
    0) echo "in/$1" ;;
    1) echo "./in/../in/$1" ;;
    2) echo "linked/$1" ;;
    3) ln -f "in/$1" "hard-$1" && echo "hard-$1" ;;
  esac
}

# refuse WORDS COMMAND...: exit code 64, says WORDS, and no input has changed.
tried=0
refuse() {
  local words=$1 code=0
  shift
  tried=$((tried + 1))
  "$program" "$@" >said.out 2>said </dev/null || code=$?
  [ $code -eq 64 ] || fail "$*: exit code $code: $(head -c 300 said)"
  grep -q "$words" said || fail "$*: says $(head -c 300 said)"
  sums in | cmp -s - sums || {
    fail "$*: an input has changed: $(sums in | diff sums - | head -3)"
    exit 1
  }
}

# Every output of a command onto every input, by turns under another name.
turn=0
over() { # OUTPUTS INPUTS COMMAND...
  local outputs=$1 inputs=$2 output input
  shift 2
  for output in $outputs; do
    for input in $inputs; do
      turn=$((turn + 1))
      refuse 'would overwrite' "$@" "$output" "$(spell "$input" $turn)"
    done
  done
}
over '-o --csv --points --overlay --html' 'scan.png design.json model.json' \
  measure in/scan.png -d in/design.json --model in/model.json
over '-o --html' 'scan.png other.png design.json' loop in/scan.png --hold-out in/other.png --design in/design.json
over '--model-out' 'scan.png other.png design.json' loop in/scan.png in/other.png --design in/design.json
over '-o --html --model-out' 'runs.csv declared.json design.json' \
  loop --table in/runs.csv --declared in/declared.json --design in/design.json
over '-o --html' 'runs.csv' doe in/runs.csv --response y --model '1 + T'
over '-o --html' 'runs.csv better.json' doe in/runs.csv --model in/better.json
over '-o --html' 'sheet.csv scan.png other.png design.json' \
  doe in/sheet.csv --scans scan --response height_mm --model 1 -d in/design.json
over '-o' 'design.json' design in/design.json
over '-o' 'design.json' design in/design.json --curve
over '-o' 'spec.json' render in/spec.json
over '-t' 'spec.json' render in/spec.json -o out.png

# Standard output that goes on with an input.
for command in 'measure in/scan.png' 'loop in/scan.png' 'render in/spec.json -o -'; do
  code=0
  # shellcheck disable=SC2086
  "$program" $command 2>said 1<>"in/$(basename "${command##* in/}" ' -o -')" || code=$?
  [ $code -eq 64 ] || fail "$command onto its input: exit code $code: $(head -c 300 said)"
  sums in | cmp -s - sums || fail "$command onto its input: it has changed"
done

# Two outputs of one name, there already or not.
touch there
for name in new there; do
  for second in "$name" "./$name" "linked/../$name"; do
    for option in --csv --points --overlay --html; do
      refuse 'two outputs' measure in/scan.png -o $name $option "$second"
    done
    refuse 'two outputs' loop in/scan.png -o $name --html "$second"
    refuse 'two outputs' loop in/scan.png -o $name --model-out "$second"
    refuse 'two outputs' loop --table in/runs.csv --declared in/declared.json --html $name --model-out "$second"
    refuse 'two outputs' doe in/runs.csv --response y --model T -o $name --html "$second"
    refuse 'two outputs' render in/spec.json -o $name -t "$second"
  done
done
[ ! -e new ] && [ ! -s there ] || fail "outputs of one name were written"
refuse 'two outputs' measure in/scan.png -o - --csv -
"$program" measure in/scan.png -o /dev/null --csv /dev/null || fail "two outputs to nowhere are fine"

# A lot's files: nothing that it is made from, in its own folder or linked there.
cp -r in lots/mine
cp in/list.csv lots/mine/manifest.csv
sums lots/mine >mine
mine() { # WORDS COMMAND...
  refuse "$@"
  sums lots/mine | cmp -s - mine || fail "$*: the folder has changed: $(sums lots/mine | diff mine - | head -3)"
}
mine 'would overwrite the list' lot lots/mine/manifest.csv -o lots/mine
mine 'would overwrite the list' lot lots/mine/manifest.csv -o lots/mine --resume
mine 'would overwrite the recipe' lot in/list.csv --recipe lots/mine/recipe.json -o lots/mine
mine 'would overwrite the recipe' lot in/list.csv --recipe lots/mine/recipe.json -o lots/mine --resume
cp in/design.json lots/mine/lot.json
cp in/model.json lots/mine/scanner_model.json
cp in/scan.png lots/mine/index.html
sums lots/mine >mine
mine 'would overwrite the design' lot in/list.csv -d lots/mine/lot.json -o lots/mine
mine 'would overwrite the scanner' lot in/list.csv --model lots/mine/scanner_model.json -o lots/mine
mine 'would overwrite the scan' lot lots/mine/index.html -o lots/mine

# Files that the lot wrote itself may be given back, from any folder.
says() { # WORDS COMMAND...
  local words=$1
  shift
  "$program" "$@" >said 2>&1 || fail "$*: exit code $?: $(cat said)"
  grep -q "$words" said || fail "$*: says $(cat said)"
}
says '1 foil of 1 scan' lot in/list.csv --model in/model.json -o lots/a
sums lots/a >a
says '1 foil of 1 scan' lot lots/a/manifest.csv -o lots/a --recipe lots/a/recipe.json --resume
sums lots/a | cmp -s - a || fail "a lot resumed by its own files is another: $(sums lots/a | diff a - | head -3)"
says '1 scan, 0 to measure, 1 kept' lot lots/a/manifest.csv -o lots/a --recipe lots/a/recipe.json --resume --dry-run
sed -i 's/,*$/,/;1s/$/note/' lots/a/manifest.csv # the user's own by now
sums lots/a >mine
code=0
"$program" lot lots/a/manifest.csv -o lots/a --resume >said 2>&1 || code=$?
[ $code -eq 64 ] && sums lots/a | cmp -s - mine || fail "an edited manifest: exit code $code: $(cat said)"

# Shards and the lot that they become; a page over lots.
for i in 1 2; do says 'shard' lot in/scan.png in/other.png -o lots/s$i --shard $i/2; done
mkdir lots/whole
ln -s ../s1/recipe.json lots/whole/recipe.json
for shard in lots/s1 lots/s2; do
  sums $shard >mine
  mine_of=$shard
  refuse 'would overwrite' merge lots/s1 lots/s2 -o $shard
  sums $mine_of | cmp -s - mine || fail "merge into $shard has changed it"
done
refuse 'would overwrite' merge lots/s1 lots/s2 -o lots/whole
rm lots/whole/recipe.json
says '2 foils of 2 scans' merge lots/s1 lots/s2 -o lots/whole
for name in lot.json index.html; do
  refuse 'would overwrite' lot --index lots/whole/$name lots/whole
done
echo "$tried refused"
exit $failed
