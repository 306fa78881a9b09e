#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Holds every JSON document that the tests make foilgauge write against the schemas of reports/schema, by Debian's
# python3-jsonschema; prints how many there are of each schema, and which members of the schemas no document has. The
# tests run with build/tests/foilgauge_kept, which keeps a copy of each document (tests/support/keep_json.c).
#   tests/bench/json_documents.sh [TEST...]     as test_lot.sh or test_report_schema: these alone
# Left out: failing memory ends documents early, and hardening is a property of the other program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
left_out='^test_(failures|hardening)\.sh$'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# A build tree as the tests look for it around the program, with the other program in it.
mkdir "$folder/build" "$folder/kept" "$folder/ended"
ln -s "$PWD"/build/* "$folder/build/"
rm "$folder/build/foilgauge"
cp build/tests/foilgauge_kept "$folder/build/foilgauge"
export folder FOILGAUGE_RENDERER=$folder/build/foilgauge

# run_test NAME: its documents go to kept/NAME; of a test that fails, its words to ended/NAME.
run_test() {
  local command=("build/tests/$1") code=0
  [ -e "tests/cli/$1" ] && command=(bash "tests/cli/$1" "$folder/build/foilgauge")
  mkdir -m 1777 "$folder/kept/$1"
  FOILGAUGE_KEEP_JSON=$folder/kept/$1 timeout 600 "${command[@]}" >"$folder/ended/$1" 2>&1 </dev/null || code=$?
  if [ $code = 0 ] || [ $code = 77 ]; then
    rm "$folder/ended/$1"
  else
    echo "exit code $code" >>"$folder/ended/$1"
  fi
}
export -f run_test

all_tests() {
  (cd tests/cli && printf '%s\n' test_*.sh) | grep -vE "$left_out"
  (cd tests/unit && printf '%s\n' test_*.c) | sed 's/\.c$//'
}
if [ $# -gt 0 ]; then printf '%s\n' "$@"; else all_tests; fi |
  xargs -P "$(($(nproc) + 1))" -I{} bash -c 'run_test {}'

code=0
/usr/bin/python3 -B tests/support/validate_documents.py reports/schema "$folder/kept" ${1:+--some} >"$folder/table" || code=$?
[ $code != 77 ] || { echo "python3-jsonschema is missing" >&2 && exit 77; }
cat "$folder/table"
for ended in "$folder"/ended/*; do
  [ -e "$ended" ] || continue
  code=1
  echo "$(basename "$ended") failed, and may have written less: $(tail -n 3 "$ended")" >&2
done
exit $code
