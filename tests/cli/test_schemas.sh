#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The schemas of reports/schema are those that the build makes of the members, and the manual lists
# the members of each.
set -u
build=$(dirname "$(realpath "$1")") source=.
failed=0
for made in "$build"/schema/*.schema.json; do
  name=$(basename "$made")
  if ! diff -u "$source/reports/schema/$name" "$made" >/dev/null 2>&1; then
    diff -u "$source/reports/schema/$name" "$made" | head -20
    echo "FAIL: reports/schema/$name is not what the members say: cp $made reports/schema/"
    failed=1
  fi
  if ! grep -q "@members_of_${name%.schema.json}@" "$source"/src/manual/text/*.5.md; then
    echo "FAIL: no page of section 5 lists the members of $name"
    failed=1
  fi
done
exit $failed
