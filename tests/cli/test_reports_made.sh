#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The list of reports says of which commit each page is, which are old, and the figure that matters, as it stands in the page; a page is
# not made twice of one commit.
. tests/support/cli.sh
skip_when_slow
command -v git >/dev/null || exit 77
python3 "$root/tests/bench/reports.py" --check
code=$?
[ $code = 0 ] || [ $code = 77 ] || fail "reports/README.md does not say what its pages say"

mkdir -p tests/bench src/core src/page reports
cp "$root"/tests/bench/report{s,_figures}.py tests/bench/
seq 40 >src/core/a.c
seq 40 >src/page/b.c
cat >reports/README.md <<'R'
# Reports

## Speed

Rooms: core. Made alone: the numbers are times.

| page | what it shows | command |
|---|---|---|
| [speed.md](speed.md) `.csv` | time | `sh count.sh speed` |
| [real.md](real.md) | one scan | `sh count.sh real SCAN.png` |

## Pages

Rooms: page.

| page | what it shows | command |
|---|---|---|
| [pages.md](pages.md) | pages \| pictures | `sh count.sh pages` |
| [broken.md](broken.md) | nothing | `sh count.sh broken`, `false` |
| [rows.md](rows.md) | inputs | `/usr/bin/python3 keeps.py --cases 9` |
R
printf 'echo $1 >>made_here\n' >count.sh
cat >keeps.py <<'P' # keeps rows, and is interrupted once
import os, sys
if "--help" in sys.argv:
    print("--fresh")
else:
    with open("asked", "a") as stream:
        print(*sys.argv[1:], file=stream)
    sys.exit(open("asked").read().count("cases") == 1)
P
git -c init.defaultBranch=main init -q . && git config user.email a@b && git config user.name a
save() { git add -A && git commit -qm "$1"; }
save first
first=$(git rev-parse --short=8 HEAD)
reports() { python3 tests/bench/reports.py "$@"; }

reports speed pages real >said || fail "two pages are not made: $(cat said)"
[ "$(sort made_here | paste -sd ' ')" = "pages speed" ] || fail "made: $(cat made_here)"
grep -q '^real.md: left out, its command needs SCAN.png' said || fail "a page without its scan: $(cat said)"
grep -q "^| \[speed.md\](speed.md) \`.csv\` | time | \`sh count.sh speed\` | [0-9-]*, \`$first\`, 0.0 min | | |" reports/README.md ||
  fail "the list does not say of which commit: $(grep speed.md reports/README.md)"
grep -qF '| pages \| pictures |' reports/README.md || fail "a bar in a cell is lost"
reports pages >said && grep -q "^pages.md: is of $first" said || fail "a page is made twice: $(cat said)"
reports broken >said && fail "a command that fails is no error"
grep -q '^broken.md: failed, see build/reports/broken.md.log' said || fail "a command that fails: $(cat said)"
reports nothing 2>said && fail "a page that nobody lists"
reports rows >said && fail "an interrupted benchmark is no error"
reports rows >said || fail "a benchmark that goes on: $(cat said)"
reports --again rows >said || fail "a benchmark made again: $(cat said)"
[ "$(paste -sd, asked)" = "--cases 9 --fresh,--cases 9,--cases 9 --fresh" ] || fail "rows of other runs: $(cat asked)"
save made

reports --check || fail "fresh pages are called old"
sed -i 's/^1.$/changed/' src/core/a.c
save change
reports --check >said && fail "sources changed by a quarter, and nothing is old"
grep -q '^reports/speed.md: its sources have changed' said || fail "an old page is not named: $(cat said)"
grep -q pages.md said && fail "a page of another room is called old"
reports --list && grep -q 'speed.md.*, \*\*old\*\* | | |$' reports/README.md || fail "the list does not say old"
reports --check || fail "an old page that is called so fails"

# The figure that matters: from a table, a text, a CSV; beside its goal, which it keeps or misses.
cat >reports/speed.md <<'P'
# Speed

Of 12 scans 11 are read in time, in 3.5 s.

## Later

| scan | error (rms) | right |
|---|---|---|
| a \| b | 1.25 (of 3) | 4/5 |
| c | 2,000 | – |
P
printf 'scan,error\na,1e-3\nb,-2\n' >reports/speed.csv
figures() { # ROW WORDS: a row of figures.csv, and what the list then says
  printf 'page,figure,goal,file,section,row,columns,pattern,take\n%s\n' "$1" >reports/figures.csv
  reports --list >said || fail "$1: $(cat said)"
  grep -qF "| $2 |" reports/README.md || fail "$1: $(grep '^| .speed.md' reports/README.md)"
  reports --check >said || fail "$1: $(cat said)"
}
figures 'speed.md,{1} of {0} in time,≥ 90 %,,,,,Of (\d+) scans (\d+) are,' '11 of 12 in time | ≥ 90 %'
figures 'speed.md,{1} of {0} in time,≥ 92 %,,,,,Of (\d+) scans (\d+) are,' '11 of 12 in time | ≥ 92 % **missed**'
figures 'speed.md,{} µm,1 to 2 µm,,Later,^a,error (rms),,' '1.25 (of 3) µm | 1 to 2 µm'
figures 'speed.md,"at most {}, {}",≤ 1.5,,Later,,error (rms); right,,max' 'at most 2000, 4 | ≤ 1.5 **missed**'
figures 'speed.md,c: {},≥ 1,,Later,^c,right,,' 'c: – | ≥ 1'
figures 'speed.md,error {},≤ 0,speed.csv,,^b,error,,' 'error -2 | ≤ 0'
figures 'speed.md,{} of {} above 1,100 %,,Later,,error (rms),"^[12]",share' '2 of 2 above 1 | 100 %'
sed -i 's/^| c | 2,000/| c | 3/' reports/speed.md
figures 'speed.md,{} at most,,,Later,,error (rms),,max' '3 at most |'
sed -i 's/^| c | 3/| c | 4/' reports/speed.md
reports --check >said && fail "a figure that its page does not say"
grep -q '^reports/speed.md says "4 at most"' said || fail "another figure: $(cat said)"
sed -i 's/(rms)/of all/' reports/speed.md
reports --check >said && fail "a figure that is not found"
grep -q 'figures.csv: "{} at most": no row "" with "error (rms)"' said || fail "no figure: $(cat said)"
reports --list >said && fail "a list without the figure"
printf 'page,figure,goal,file,section,row,columns,pattern,take\nnone.md,a,,,,,,b,\n' >reports/figures.csv
reports --check >said && fail "a figure of no page"

exit $failed
