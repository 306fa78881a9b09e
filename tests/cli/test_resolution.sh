#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Oddities of a scan's resolution are reported: on the terminal, in JSON and on the page.
. tests/support/cli.sh
cd "$root" || exit 1
folder=$work

# render NAME DPI
render() {
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":2,\"foils\":[{\"design\":{\"bump_count\":3}}],\"scanner\":{\"dpi\":$2}}" \
    >"$folder/$1.spec"
  "$program" render "$folder/$1.spec" -o "$folder/$1.png" || fail "render $1"
}

# said FLAG NOTE ARGUMENT...: `measure` says it in all places; with FLAG "" in none.
said() {
  local flag=$1 note=$2
  shift 2
  "$program" measure "$@" -o "$folder/a.json" --html "$folder/a.html" >/dev/null 2>"$folder/stderr"
  if [ -z "$flag" ]; then
    grep -qE 'resolution_contradicts_file|unequal_resolution' "$folder/a.json" && fail "$*: a flag too many"
    [ -s "$folder/stderr" ] && fail "$*: says $(cat "$folder/stderr")"
    return
  fi
  grep -q "\"$flag\"" "$folder/a.json" || fail "$*: no $flag in the JSON"
  grep -q "\"note\": \"$note" "$folder/a.json" || fail "$*: no note in the JSON"
  grep -q "$note" "$folder/stderr" || fail "$*: no '$note' on standard error"
  grep -q 'The resolution' "$folder/a.html" || fail "$*: not on the page"
}

render plain 2400
render tall '[2400,1800]'
render double '[2400,1200]'
said '' '' "$folder/plain.png"
said '' '' "$folder/plain.png" --dpi 2405
said resolution_contradicts_file 'measured at 2300 dpi as was given, but the file says 2400' "$folder/plain.png" --dpi 2300
said unequal_resolution 'the resolutions along x and y differ: 2400 × 1800 dpi' "$folder/tall.png"
said resolution_contradicts_file 'measured at 2400 dpi as was given' "$folder/tall.png" --dpi 2400

# A resolution that is a multiple of the other: pixels are averaged, no flag, and the page's picture is that of the pixels.
note='it has 2400 × 1200 dpi: every 2 columns were averaged to one, so that pixels are square'
"$program" measure "$folder/double.png" -o "$folder/a.json" --html "$folder/a.html" >/dev/null 2>"$folder/stderr" || fail "2400 × 1200 dpi"
grep -q "$note" "$folder/stderr" || fail "no '$note' on standard error"
grep -q "\"note\": \"$note" "$folder/a.json" || fail "no '$note' in the JSON"
grep -q 'unequal_resolution\|contradicts_file' "$folder/a.json" && fail "2400 × 1200 dpi: a flag too many"
grep -q '1200 × 1200 dpi (the file says 2' "$folder/a.html" || fail "the page does not say what the file states"
grep -q 'data:image' "$folder/a.html" || fail "no picture on the page"

exit $failed
