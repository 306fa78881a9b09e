#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The rooms of the code (src/README.md): a report reads public results only, and an effect's id
# stands in its row and nowhere else.
set -u
failed=0

say() {
  echo "FAILED: $1"
  failed=1
}

private='#include "(field|rows|effect|effect_search|scan_loop|table_loop)/'
found=$(grep -nE "$private" -r src/report)
[ -z "$found" ] || say "a report includes what is private to the loop: $found"

# The program is a user of the library like any other.
found=$(grep -nE '^ *#include "' -r src/cli | grep -vE '"(cli|foilgauge)/')
[ -z "$found" ] || say "the program includes what is private to the library: $found"
found=$(grep -nE '^ *#include "' -r include | grep -v '"foilgauge/')
[ -z "$found" ] || say "a public header includes a private one: $found"

# Left is used by right, never the other way.
must_not_include() {
  found=$(grep -nE "#include \"($2)/" -r "src/$1")
  [ -z "$found" ] || say "$1 includes what stands right of it: $found"
}
must_not_include field 'rows|effect|effect_search|scan_loop|table_loop|report|lot|cli'
must_not_include forming 'scan|vision|measure|scan_loop|table_loop|report|lot|cli'
must_not_include rows 'effect|effect_search|scan_loop|table_loop|report|lot|cli'
must_not_include effect 'effect_search|scan_loop|table_loop|report|lot|cli'
must_not_include effect_search 'scan_loop|report|lot|cli'
must_not_include scan_loop 'report|lot|cli'
must_not_include table_loop 'scan_loop|effect_search|report|lot|cli'
must_not_include die 'scan|vision|measure|scan_loop|table_loop|report|lot|cli'
must_not_include load_test 'scan|vision|measure|scan_loop|table_loop|report|lot|cli'
must_not_include report 'cli'

ids=$(grep -rhoE '(\.id = |OVER_GLASS\()"[^"]+"' src/effect | grep -oE '"[^"]+"')
[ "$(echo "$ids" | wc -l)" -ge 30 ] || say "the effects' ids are not found where they should be"
any=$(echo "$ids" | tr -d '"' | sed 's/\./\\./g' | paste -sd '|')
found=$(grep -rnE --include=*.c --include=*.h "\"([^\"]*[^a-z_.\"])?($any)([^a-z_.\"][^\"]*)?\"" src |
  grep -vE '^src/(effect|render)/')
[ -z "$found" ] || say "an effect is told by its id: $found"

exit $failed
