#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The list of reports says of which commit each page is, and which are old; a page is not made twice of one commit.
. tests/support/cli.sh
skip_when_slow
command -v git >/dev/null || exit 77
python3 "$root/tests/bench/reports.py" --check
code=$?
[ $code = 0 ] || [ $code = 77 ] || fail "reports/README.md does not say which pages are old"

mkdir -p tests/bench src/core src/page reports
cp "$root/tests/bench/reports.py" tests/bench/
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
R
printf 'echo $1 >>made_here\n' >count.sh
git -c init.defaultBranch=main init -q . && git config user.email a@b && git config user.name a
save() { git add -A && git commit -qm "$1"; }
save first
first=$(git rev-parse --short=8 HEAD)
reports() { python3 tests/bench/reports.py "$@"; }

reports speed pages real >said || fail "two pages are not made: $(cat said)"
[ "$(sort made_here | paste -sd ' ')" = "pages speed" ] || fail "made: $(cat made_here)"
grep -q '^real.md: left out, its command needs SCAN.png' said || fail "a page without its scan: $(cat said)"
grep -q "^| \[speed.md\](speed.md) \`.csv\` | time | \`sh count.sh speed\` | [0-9-]*, \`$first\`, 0.0 min |" reports/README.md ||
  fail "the list does not say of which commit: $(grep speed.md reports/README.md)"
grep -qF '| pages \| pictures |' reports/README.md || fail "a bar in a cell is lost"
reports pages >said && grep -q "^pages.md: is of $first" said || fail "a page is made twice: $(cat said)"
reports broken >said && fail "a command that fails is no error"
grep -q '^broken.md: failed, see build/reports/broken.md.log' said || fail "a command that fails: $(cat said)"
reports nothing 2>said && fail "a page that nobody lists"
save made

reports --check || fail "fresh pages are called old"
sed -i 's/^1.$/changed/' src/core/a.c
save change
reports --check >said && fail "sources changed by a quarter, and nothing is old"
grep -q '^reports/speed.md: its sources have changed' said || fail "an old page is not named: $(cat said)"
grep -q pages.md said && fail "a page of another room is called old"
reports --list && grep -q 'speed.md.*, \*\*old\*\* |$' reports/README.md || fail "the list does not say old"
reports --check || fail "an old page that is called so fails"

exit $failed
