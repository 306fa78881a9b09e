#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Standard streams that are closed, full or gone, and signals: what every command must make of them.
. "$(dirname "$0")/../support/loop.sh"
mkdir -p out scans

cat >spec.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{}], "scanner": {"dpi": 1200}}
SPEC
"$renderer" render spec.json -o scans/a.png || fail "render"
cp scans/a.png scans/b.png
printf 'T,D,y\n' >runs.csv
for i in 1 2 3 4 5 6 7 8 9 10; do echo "$((i % 3)),$((i % 2)),$((i * i % 7)).$i" >>runs.csv; done
model='1 + T + D'

# nothing_left WHAT: no temporary file lies where outputs go.
nothing_left() {
  local left
  left=$(find . -name '.foilgauge*')
  [ -z "$left" ] || fail "$1 leaves $left"
  find . -name '.foilgauge*' -delete
}

# A full disk is called so, whoever writes to standard output, and whatever he writes.
full() {
  local code=0
  "$program" "$@" >/dev/full 2>said || code=$?
  [ $code -eq 74 ] || fail "$* >/dev/full: exit code $code: $(cat said)"
  grep -q 'standard output: cannot be written: No space left on device' said ||
    fail "$* >/dev/full says: $(cat said)"
  nothing_left "$*"
}
if [ -e /dev/full ]; then
  full --help
  full help
  full version
  for command in measure doe 'doe plan' design loop 'loop --table x' render lot merge; do
    # shellcheck disable=SC2086
    full $command --help
  done
  full measure scans/a.png
  full measure scans/a.png -o -
  full measure scans/a.png -o out/a.json --csv -
  full measure scans/a.png -o out/a.json --overlay -
  full measure scans/a.png -o out/a.json --html -
  full doe runs.csv --response y --model "$model"
  full doe runs.csv --response y --model "$model" -o out/a.json --html -
  full doe plan --factor T=1:2 --factor D=1:2
  full design
  full design --json
  full design --curve
  full loop scans/a.png
  full loop scans/a.png -o out/a.json --html -
  full loop scans/a.png -o out/a.json --model-out -
  full loop --table runs.csv --response y --model "$model"
  full loop --table runs.csv --response y --model "$model" -o out/a.json --html -
  full render spec.json -o - -t out/t.json
  full render spec.json -o out/a.png -t -
  full lot scans -o out/lot --dry-run
  full lot --print-recipe
fi
[ -z "$(ls -A out)" ] || fail "a full standard output leaves $(ls -A out)"

# A disk that fills up in the middle of a file is called so, too: the first write that fails says why.
code=0
(ulimit -f 40 && exec "$program" render spec.json -o out/a.png -t out/t.json) 2>said || code=$?
[ $code -eq 74 ] && grep -q 'out/a.png: cannot be written: File too large' said ||
  fail "render on a full disk: exit code $code: $(cat said)"
nothing_left "render on a full disk"

# Closed at the start: a message does not land in a file that is opened later.
"$program" measure scans/a.png lost.png -o out/a.json 2>&- && fail "a scan that is not there: exit code 0"
python3 -m json.tool out/a.json >/dev/null || fail "standard error closed: a message in the JSON report"
mkdir more
cp scans/a.png more/a.png
echo no scan >more/b.png
"$program" lot more -o out/lot 2>&-
grep -q foilgauge: out/lot/results.jsonl && fail "standard error closed: a message in results.jsonl"
"$program" lot more -o out/lot --resume --dry-run 2>&- >said ||
  fail "results.jsonl cannot be read after a run without standard error"
rm -rf out/lot out/a.json more
code=0
"$program" design --json >&- 2>said || code=$?
[ $code -eq 74 ] && grep -q 'standard output: cannot be written' said ||
  fail "standard output closed: exit code $code: $(cat said)"
"$program" design -o out/d.json >&- 2>said || fail "standard output closed, -o: $(cat said)"
code=0
"$program" measure - -o out/a.json <&- 2>said || code=$?
[ $code -eq 74 ] && grep -q 'standard input' said || fail "standard input closed: exit code $code: $(cat said)"

# A reader that has gone is a write error.
gone() {
  local code=0
  { "$program" "$@" 2>said || echo $? >code; } | sleep 0
  code=$(cat code)
  [ "$code" = 74 ] || fail "$*: a reader that has gone: exit code $code"
  grep -q 'standard output: cannot be written: Broken pipe' said || fail "$*: says $(cat said)"
  nothing_left "$* and a reader that has gone"
}
gone render spec.json -o - -t out/t.json
gone measure scans/a.png -o out/a.json --csv -
gone loop scans/a.png --html -

# interrupted SIGNAL COMMAND...: once its temporary file is there. Exit code 130, and it is gone.
interrupted() {
  local signal=$1 pid code=0 i
  shift
  "$program" "$@" 2>said <hold &
  pid=$!
  for ((i = 0; i < 200; i++)); do
    [ -n "$(find . -name '.foilgauge*')" ] && break
    sleep 0.02
  done
  kill -s "$signal" $pid
  wait $pid || code=$?
  [ $code -eq 130 ] || fail "$*: $signal: exit code $code"
  grep -q interrupted said || fail "$*: $signal: says $(cat said)"
  nothing_left "$* and $signal"
}
mkfifo hold
exec 9<>hold # a standard input that neither gives nor ends
cat >large.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 3, "foils": [{}], "scanner": {"dpi": 9600, "noise": 2}}
SPEC
for signal in TERM HUP; do
  interrupted $signal measure - -o out/a.json --csv out/a.csv
  interrupted $signal loop hold -o out/a.json --html out/a.html
  interrupted $signal render large.json -o out/a.png -t out/t.json
done

# Ignored signals stay ignored (nohup).
(trap '' HUP && exec "$program" measure - -o out/a.json <hold 2>said) &
pid=$!
sleep 0.3
kill -HUP $pid
sleep 0.1
kill -0 $pid || fail "a hang-up that is ignored ends the program"
kill -TERM $pid
wait $pid

# A lot and its merging, at any time: whole records stay, temporary files do not.
for i in 1 2; do "$program" lot scans -o "out/s$i" --shard $i/2 2>/dev/null; done
for delay in 0.002 0.005 0.01 0.02 0.04 0.08; do
  for command in 'merge out/s1 out/s2 -o out/m' 'lot scans -o out/l --resume'; do
    # shellcheck disable=SC2086
    : >said
    "$program" $command 2>said &
    pid=$!
    sleep $delay
    kill -TERM $pid 2>/dev/null
    code=0
    wait $pid || code=$?
    # 143: before the program had begun; 127: so early that bash has no record of it
    [ $code -le 2 ] || [ $code -eq 127 ] || [ $code -eq 130 ] || [ $code -eq 143 ] ||
      fail "$command ended after $delay s: exit code $code: $(cat said)"
    nothing_left "$command ended after $delay s"
  done
done
code=0
"$program" lot scans -o out/l --resume 2>said || code=$?
[ $code -le 2 ] || fail "a lot that was interrupted does not go on: $(cat said)"

# A run that is killed cannot tidy up: the next one does, and leaves alone what another is at work on.
"$program" measure - -o out/a.json <hold 2>/dev/null &
killed=$!
"$program" measure - -o out/b.json <hold 2>/dev/null &
alive=$!
for ((i = 0; i < 100; i++)); do
  [ "$(find out -name '.foilgauge*' | wc -l)" -ge 2 ] && break
  sleep 0.02
done
kill -KILL $killed
wait $killed 2>/dev/null || true
"$program" measure scans/a.png -o out/a.json || fail "measure after one that was killed"
"$program" measure scans/a.png -o out/b.json || fail "measure beside another run"
[ "$(find out -name '.foilgauge*' | wc -l)" -eq 1 ] || fail "after a killed run: $(ls -A out)"
kill -TERM $alive
wait $alive
nothing_left "a killed run"
exit $failed
