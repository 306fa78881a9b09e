#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# foilgauge render: exit codes, no file left behind on failure, the same bytes, bounded memory.
. tests/support/cli.sh
cd "$root" || exit 1
folder=$work

expect 64 'SPEC.json' "$program" render
expect 64 'where the scan goes' "$program" render samples/render/clean.json
expect 74 'nosuch.json' "$program" render "$folder/nosuch.json" -o "$folder/a.png"
echo '{"schema":"foilgauge/render/1","scanner":{"dpi":-1}}' >"$folder/bad.json"
expect 65 'scanner.dpi' "$program" render "$folder/bad.json" -o "$folder/a.png"
expect 74 'nowhere' "$program" render samples/render/clean.json -o "$folder/nowhere/a.png"
expect 74 'nowhere' "$program" render samples/render/clean.json -o "$folder/a.png" \
  --truth "$folder/nowhere/t.json"
ls -A "$folder" | grep -q 'a\.png' && fail "left behind: $(ls -A "$folder")"

tiers="clean rough harsh cantilever" dpi=2400
[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || tiers=harsh dpi=1200
for tier in $tiers; do
  sed "s/\"dpi\": 4800/\"dpi\": $dpi/" "samples/render/$tier.json" >"$folder/$tier.spec"
  expect 0 '' "$program" render "$folder/$tier.spec" -o "$folder/$tier.png" --truth "$folder/$tier.json"
  "$program" render "$folder/$tier.spec" -o - | cmp - "$folder/$tier.png" ||
    fail "$tier: not the same bytes"
  grep -q '"foilgauge/truth/1"' "$folder/$tier.json" || fail "$tier: no truth"
done

# 100 million pixels: held whole, coverage alone would be 400 MB. The limit is on address space, and
# the shared libraries take most of it. A sanitizer needs terabytes of it.
cat >"$folder/wide.json" <<'END'
{"schema":"foilgauge/render/1","width_px":25000,"height_px":4000,
 "foils":[{"repeat":2,"rotate_deg":-90}],"scanner":{"noise":0}}
END
if [ -n "${FOILGAUGE_TEST_LONG-}" ] && ! nm "$program" 2>/dev/null | grep __asan >/dev/null; then
  expect 0 '' bash -c "ulimit -v 250000; exec '$program' render '$folder/wide.json' -o /dev/null"
fi
exit $failed
