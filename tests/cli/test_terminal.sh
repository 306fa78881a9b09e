#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Messages of commands: results on a terminal beside the files that were asked for, which quantities fail, a lot's name,
# folders and scans that are not there, the place where a file is no JSON.
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh
sample=$root/samples

# terminal COMMAND...: what the command shows on a terminal, as `shown`.
terminal() {
  python3 -c 'import pty, sys; pty.spawn(sys.argv[1:])' "$@" >shown </dev/null
}
says() { # WORDS: of `shown`
  grep -qE -e "$1" shown || fail "the terminal does not say '$1': $(tail -n 5 shown)"
}

render() { # NAME SEED
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":$2,\"foils\":[{\"design\":{\"bump_count\":3},\"radius_springback\":{\"mean\":0.05,\"sd\":0.01}}],\"scanner\":{\"dpi\":1200,\"noise\":1}}" >spec.json
  "$renderer" render spec.json -o "$1" || fail "render $1"
}
mkdir scans
render scans/a.png 1
render scans/b.png 2
echo '{"schema":"foilgauge/design/1","bump_count":3,"calibration": "not needed: the scan is rendered", "tolerances":{"radius_mm":{"max":3.4},"height_mm":{"min":0.1},"overall.radius_mm":{"max":20.5}}}' >design.json

# The table is shown whatever files are written besides, and once.
for outputs in '-o a.json' '--html a.html' '-o a.json --html a.html --csv a.csv'; do
  # shellcheck disable=SC2086
  terminal "$program" measure scans/a.png $outputs
  [ "$(grep -c 'foil 1: 3 bumps' shown)" = 1 ] || fail "measure $outputs shows nothing on a terminal"
done
terminal "$program" measure scans/a.png -o -
grep -q 'foil 1: 3 bumps' shown && fail "measure -o - shows a table, too"
for outputs in '-o d.json' '--html d.html' '-o d.json --html d.html'; do
  # shellcheck disable=SC2086
  terminal "$program" die "$sample"/die/*.txt $outputs
  says 'concave'
done
terminal "$program" die "$sample"/die/*.txt --table d.txt --html d.html
[ -s d.txt ] || fail "no table"
grep -q "die against design" shown && fail "a table that goes to a file is shown besides"
expect 0 '' "$program" die "$sample"/die/*.txt --html d.html
[ ! -s stdout ] || fail "die --html writes to a pipe"

# The quantities that fail, and how many values of each.
terminal "$program" measure scans/a.png -d design.json
says 'OUT OF TOLERANCE: 4 value\(s\) beyond a limit: bump radius \(3\), overall radius\.'

# A lot is called as its folder is, unless it has a name.
expect 0 '' "$program" lot scans -o lot7
[ "$(value lot7/lot.json 'r["name"]')" = lot7 ] || fail "lot7 is called $(value lot7/lot.json 'r["name"]')"
grep -q '<h1[^>]*>\(<[^>]*>\)*lot7<' lot7/index.html || fail "the page does not say lot7"
(cd lot7 && expect 0 '' "$program" lot ../scans -o ./ --resume)
[ "$(value lot7/lot.json 'r["name"]')" = lot7 ] || fail "from within, lot7 is called $(value lot7/lot.json 'r["name"]')"
expect 0 '' "$program" lot scans -o named --name 'Coil 4'
[ "$(value named/lot.json 'r["name"]')" = 'Coil 4' ] || fail "--name"
for i in 1 2; do expect 0 '' "$program" lot scans -o part$i --shard $i/2; done
expect 0 '' "$program" merge part1 part2 -o lot8
[ "$(value lot8/lot.json 'r["name"]')" = lot8 ] || fail "a merged lot is called $(value lot8/lot.json 'r["name"]')"

# A folder that is not there is an error with its name; a scan that is not there is counted apart.
expect 74 'nowhere: the folder cannot be opened: No such file' "$program" lot nowhere -o none
[ ! -e none ] || fail "a lot of a folder that is not there"
expect 74 'nowhere/: the folder cannot be opened' "$program" lot scans nowhere/ -o none --dry-run
expect 74 "'': the folder cannot be made" "$program" lot scans -o ''
expect 74 "nowhere: the folder cannot be opened" "$program" merge nowhere part2 -o none
listened=stdout
expect 0 '^3 scans, 2 to measure, 0 kept, 1 missing: scans/c.png$' "$program" lot scans scans/c.png -o none --dry-run
expect 0 '^4 scans, 2 to measure, 0 kept, 2 missing: the first is d.png$' "$program" lot scans d.png scans/c.png -o none --dry-run
listened=stderr

# The place where a file stops being JSON: line, column, and the line.
printf '{"schema": "foilgauge/recipe/1",\n "name": 3x}' >bad.json
expect 65 'bad.json: line 2, column 11: this is not JSON: "name": 3x' "$program" lot scans --recipe bad.json -o none
expect 65 'bad.json: line 2, column 11: this is not JSON: "name": 3x' "$program" render bad.json -o none.png

exit $failed
