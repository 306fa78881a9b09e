# SPDX-License-Identifier: GPL-3.0-or-later
# Shared functions of the scripts that try the program; sourced from the checkout with the program's path. Works in a
# folder of its own, `work`; `root` is the checkout. A script ends with `exit $failed`.
set -u
. "${BASH_SOURCE[0]%/*}/checks.sh"
program=$(realpath "$1")
root=$PWD
# Draws what the tests look at: a build that is not slowed down by sanitizers, where there is one.
renderer=${FOILGAUGE_RENDERER-}
[ -x "$renderer" ] || renderer=$program
work=$(mktemp -d)
# A child that is killed before it runs its program runs this trap, too: the folder is its parent's.
trap '[ "$BASHPID" != $$ ] || rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0

fail() {
  echo "FAIL: $*"
  failed=1
}

# expect CODE WORDS COMMAND...: the exit code, and words (a regular expression) in what the command wrote to the streams
# in `listened`. Both streams stay in $work/stdout and $work/stderr.
listened=stderr
expect() {
  local code=$1 words=$2 got=0
  shift 2
  "$@" >"$work/stdout" 2>"$work/stderr" || got=$?
  [ $got = "$code" ] || fail "exit code $got, not $code: $* ($(head -c 300 "$work/stderr"))"
  [ -z "$words" ] || (cd "$work" && cat $listened) | grep -qaE -e "$words" ||
    fail "$*: no '$words' in: $(cd "$work" && cat $listened | head -c 600)"
}

# links FILE: every relative link of a page of Markdown leads to something that is there.
links() {
  local link count=0
  while read -r link; do
    count=$((count + 1))
    [ -e "$(dirname "$1")/${link%%#*}" ] || fail "$1: the link $link leads nowhere"
  done < <(grep -oE '\]\([^)]+\)' "$1" | sed 's/^](//; s/)$//' | grep -vE '^[a-z]+:|^#')
  [ $count -gt 0 ] || fail "$1 has no links"
}

# same A B: the same files with the same bytes.
same() {
  diff -r "$1" "$2" >"$work/difference" 2>&1 || fail "$1 and $2 differ: $(head -n 3 "$work/difference")"
}

# value FILE EXPRESSION: a number or word out of a report.
value() {
  python3 -c "import json,sys; r=json.load(open(sys.argv[1])); print(eval(sys.argv[2]))" "$1" "$2"
}

# near NAME VALUE EXPECTED TOLERANCE
near() {
  python3 -c "import sys; sys.exit(not abs(float(sys.argv[1]) - float(sys.argv[2])) <= float(sys.argv[3]))" \
    "$2" "$3" "$4" || fail "$1 is $2, not $3 within $4"
}

# valid SCHEMA FILE...: the files keep to a schema of reports/schema, where python3 and its jsonschema are there.
valid() {
  local code=0
  python3 "$root/tests/support/validate_schema.py" "$root/reports/schema" "$@" || code=$?
  [ $code -eq 0 ] || [ $code -eq 77 ] || [ $code -eq 127 ] || fail "$* does not validate"
}

# brief: whether this build is slow, and fewer cases of the same code are enough.
brief() {
  [ -n "${FOILGAUGE_TEST_BRIEF-}" ] && [ -z "${FOILGAUGE_TEST_LONG-}" ]
}

# Builds with sanitizers are slow: what says little more there than other scripts is left to their long tier.
skip_when_slow() {
  brief || return 0
  echo "skipped: this build is slow; tests/run.sh --long runs it"
  exit 77
}

# Skips, without --long, a script that takes long and says more of accuracy than of right and wrong.
long_only() {
  [ -n "${FOILGAUGE_TEST_LONG-}" ] && return 0
  echo "skipped: tests/run.sh --long runs it"
  exit 77
}
