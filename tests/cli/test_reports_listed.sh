#!/bin/bash
# reports/README.md names every file of reports/, nothing that is not there, and only commands whose script exists.
. tests/support/cli.sh
skip_when_slow

page=$root/reports/README.md
links "$page"

# The first cell of a row: links and `names` (patterns, too); one that begins with a dot shares the stem of the one before.
sed -n 's/^| \([^|]*\) |.*/\1/p; /^`/s/ .*//p' "$page" | grep -vE '^(page|---)' |
  grep -oE '\]\([^)]+\)|`[^`]+`' | sed -E 's/^(\]\(|`)//; s/[)`:]+$//' |
  while read -r name; do
    case $name in
    .*) echo "${stem%.*}$name" ;;
    *) stem=$name && echo "$name" ;;
    esac
  done >"$work/names"
[ "$(wc -l <"$work/names")" -gt 80 ] || fail "the names in $page are not found"

cd "$root/reports" || exit 1
while read -r name; do
  compgen -G "$name" >>"$work/listed" || fail "reports/README.md names $name, which is not there"
done <"$work/names"
find . -type f ! -name '*.tmp' ! -path ./README.md | sed 's|^\./||' | sort >"$work/there"
sort -u "$work/listed" | comm -13 - "$work/there" >"$work/unlisted"
[ -s "$work/unlisted" ] && fail "no row of reports/README.md names: $(paste -sd ' ' "$work/unlisted")"

cd "$root" || exit 1
for script in $(grep -oE '\btests/[a-z_/]+\.(sh|py)' "$page" | sort -u); do
  [ -e "$script" ] || fail "reports/README.md says $script, which is not there"
done
for program in $(grep -oE 'build/(bench|tests)/[a-z_]+' "$page" | sort -u); do
  ls tests/bench/"${program##*/}".c tests/unit/"${program##*/}".c 2>/dev/null | grep -q . ||
    fail "reports/README.md says $program, of which there is no source"
done

exit $failed
