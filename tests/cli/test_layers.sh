#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The rooms of the code (src/README.md): a room includes what stands on the floors above it, and an effect's id
# stands in its row and nowhere else.
set -u
failed=0

say() {
  echo "FAILED: $1"
  failed=1
}

# Permitted includes follow from the floors in src/README.md.
python3 -B tests/house/house.py layers circles || failed=1

ids=$(grep -rhoE '(\.id = |OVER_GLASS\()"[^"]+"' src/effect | grep -oE '"[^"]+"')
[ "$(echo "$ids" | wc -l)" -ge 30 ] || say "the effects' ids are not found where they should be"
any=$(echo "$ids" | tr -d '"' | sed 's/\./\\./g' | paste -sd '|')
found=$(grep -rnE --include=*.c --include=*.h "\"([^\"]*[^a-z_.\"])?($any)([^a-z_.\"][^\"]*)?\"" src |
  grep -vE '^src/(effect|render)/')
[ -z "$found" ] || say "an effect is told by its id: $found"

exit $failed
