#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The parts of the long tier: each is listed by --help, its commands and scripts exist and parse, its pages are listed ones;
# one that fails is told at last, one that is skipped does not fail.
. tests/support/cli.sh
skip_when_slow
cd "$root" || exit 1
. tests/long.sh

tests/run.sh --help >"$work/help" || fail "--help"
[ "$(long_names | wc -l)" -ge 12 ] || fail "the parts are not found: $(long_names | paste -sd ' ')"
[ "$(long_names | sort -u | wc -l)" = "$(long_names | wc -l)" ] || fail "two parts of one name"
for part in $(long_names); do
  grep -q "^ *$part: " "$work/help" || fail "--help does not name $part"
  [ -n "$(long_commands "$part")" ] || fail "$part has no command"
done
tests/run.sh --long none 2>"$work/said" && fail "a part that is none"
grep -q "no part is named 'none'" "$work/said" || fail "a part that is none: $(cat "$work/said")"

long_parts | grep -c '^  ' >"$work/there"
for part in $(long_names); do long_commands "$part"; done >"$work/commands"
[ "$(wc -l <"$work/commands")" = "$(cat "$work/there")" ] || fail "a command is of no part"
while read -r command; do
  bash -n -c "$command" || fail "$command"
  read -r first rest <<<"$command"
  by=
  case $first in
    python3 | bash) by=$first first=${rest%% *} ;;
    ctest) continue ;;
  esac
  case $first in
    *.sh) bash -n "$first" || fail "$command" ;;
    *.py) python3 -c 'import ast, sys; ast.parse(open(sys.argv[1]).read())' "$first" || fail "$command" ;;
    *) fail "what is $first of '$command'?" ;;
  esac
  [ -n "$by" ] || [ -x "$first" ] || fail "$first cannot be run"
  for page in $([[ $command = *reports.py* ]] && grep -oE '[a-z_/]+\.(md|csv)' <<<"$command"); do
    grep -qE "^\| (\[[^]]*\]\($page\)|\`$page\`)" reports/README.md || fail "$page of '$command' is no page of the list"
  done
done <"$work/commands"

# Running parts, on parts of the test's own.
cd "$work" || exit 1
long_parts() { printf 'one: a\n  echo first\n  exit 77\n  echo third; cat\ntwo: b\n  echo before\n  exit 3\n  echo never\nthree: c\n  echo later\n'; }
run_long one two three >said && fail "a part that fails is no failure"
grep -q '^part one: passed' said && grep -q '^part two: FAILED (exit code 3 of: exit 3)' said && grep -q '^part three: passed' said &&
  grep -q '^skipped: exit 77' said && [ "$(tail -n 1 said)" = "parts that failed: two" ] || fail "parts: $(cat said)"
[ "$(cat build/long/one.log build/long/two.log build/long/three.log | paste -sd ' ')" = "first third before later" ] || fail "logs of the parts"
run_long one >said || fail "a part alone"
long_parts() { printf 'slow: a\n  sleep 97 & echo $! >child; sleep 98\n'; }
(run_long slow) >said &
for ((i = 0; i < 100; i++)); do [ -s child ] && break || sleep 0.1; done
kill %1
wait %1 && fail "a run that was ended is a success"
for ((i = 0; i < 50; i++)); do kill -0 "$(cat child)" 2>/dev/null || break; sleep 0.1; done
! kill -0 "$(cat child)" 2>/dev/null || fail "a run that was ended goes on"
exit $failed
