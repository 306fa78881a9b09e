#!/bin/bash
# CONTRIBUTING, CODEOWNERS and CHANGELOG name files, tests and rooms that are there, and every room has an owner.
. tests/support/cli.sh
skip_when_slow

for page in CONTRIBUTING CHANGELOG; do links "$root/.github/$page.md"; done
cd "$root" || exit 1

# Files, scripts and tests that the guide names.
grep -oE '\b(tests|src|samples)/[A-Za-z0-9_/.*-]+' .github/CONTRIBUTING.md | sed 's/[.)]*$//' | sort -u | while read -r path; do
  compgen -G "$path" >/dev/null || echo "$path"
done >"$work/gone"
[ -s "$work/gone" ] && fail "CONTRIBUTING.md names what is not there: $(paste -sd ' ' "$work/gone")"
for test in $(grep -oE '\b(unit|cli)\.test_[a-z_]+' .github/CONTRIBUTING.md | sort -u); do
  compgen -G "tests/${test%%.*}/${test#*.}.*" >/dev/null || fail "CONTRIBUTING.md names $test, which is not there"
done

# Owners: of rooms that are there, and of every room of the map.
awk '!/^#/ && NF { print $1 }' .github/CODEOWNERS | while read -r path; do
  [ "$path" = "*" ] || [ -d ".$path" ] || echo "$path"
done >"$work/gone"
[ -s "$work/gone" ] && fail "CODEOWNERS names what is not there: $(paste -sd ' ' "$work/gone")"
sed -n 's/^| \([a-z_/]*\)\/ |.*/\1/p' src/README.md | while read -r room; do
  grep -q "^/src/$room/ " .github/CODEOWNERS || echo "$room"
done >"$work/unowned"
[ -s "$work/unowned" ] && fail "CODEOWNERS has no owner of: $(paste -sd ' ' "$work/unowned")"

# The version that is built has its section.
grep -q "^## \[$("$program" version | cut -d' ' -f2)\]" .github/CHANGELOG.md || fail "CHANGELOG.md has no section of this version"

exit $failed
