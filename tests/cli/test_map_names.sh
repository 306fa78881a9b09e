#!/bin/bash
# src/README.md can be followed by grep: every file, folder and function that it names is there.
. tests/support/cli.sh
skip_when_slow

map=$root/src/README.md
links "$map"
cd "$root/src" || exit 1

grep -oE '`[^`]+`' "$map" | tr -d '`' | grep -E '^[a-zA-Z_/]*(\.c|\.cpp|\.h|\.json|\.md|\.sh|\.py|/)$|^[a-z_/]+\*[a-z_]*\.(c|h)$' | sort -u >"$work/files"
[ "$(wc -l <"$work/files")" -gt 40 ] || fail "the files that $map names are not found"
while read -r file; do
  case $file in
  *NAME*) continue ;;
  */*) compgen -G "$file" || compgen -G "../$file" ;;
  build/* | *) find . -path "*/$file" ;;
  esac | grep -q . || case $file in build/*) ;; *) fail "src/README.md names $file, which is not there" ;; esac
done <"$work/files"

grep -oE '\bfg_[a-z0-9_]+' "$map" | sort -u >"$work/names"
[ "$(wc -l <"$work/names")" -gt 50 ] || fail "the functions that $map names are not found"
grep -rhoE --include=*.c --include=*.h '\bfg_[a-z0-9_]+' . ../include | sort -u | comm -13 - "$work/names" >"$work/gone"
[ -s "$work/gone" ] && fail "src/README.md names what no file has: $(paste -sd ' ' "$work/gone")"

# A walk is read in one go.
awk '/^## The walk/ { title = $0; lines = 0 } /^## / && !/^## The walk/ { title = "" }
  title && /^ *[0-9]+\. |^   / { if (++lines == 16) print title }' "$map" >"$work/long"
[ -s "$work/long" ] && fail "longer than 15 lines: $(cat "$work/long")"

# A word is defined once.
sed -n '/^## Words/,/^## /s/^| \([^|]*\) |.*/\1/p' "$map" | tr ',' '\n' | sed 's/^ *//; s/ *$//' | sort | uniq -d >"$work/twice"
[ -s "$work/twice" ] && fail "defined twice: $(cat "$work/twice")"

exit $failed
