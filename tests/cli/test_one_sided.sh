#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tolerances with one limit, as most drawings have them: a page draws what passes as what passes, labels do not lie over
# each other, and a lot's worst three are those nearest to a limit.
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh

render() { # NAME SEED FOIL
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":$2,\"foils\":[$3],\"scanner\":{\"dpi\":1200,\"noise\":2}}" >spec.json
  "$renderer" render spec.json -o "$1.png" || fail "render $1"
}
design() { # NAME TOLERANCES
  echo "{\"schema\":\"foilgauge/design/1\",\"bump_count\":9,\"calibration\":\"not needed: the scan is rendered\",\"tolerances\":{$2}}" >"$1.json"
}

# Marks that each plot of a page draws: arrows, crosses, and labels that lie over each other.
cat >drawn.py <<'P'
import re, sys
page = open(sys.argv[1], encoding="utf-8").read()
arrows = crosses = over = 0
for svg in re.findall(r'<svg class="plot".*?</svg>', page, re.S):
    arrows += len(re.findall(r'class="beyond-limit" d="M[\d.]+ [\d.]+l0 ', svg))
    crosses += len(re.findall(r'class="beyond-limit" d="M[\d.]+ [\d.]+l16 ', svg))
    boxes = []
    for attributes, text in re.findall(r'<text ([^>]*)>([^<]*)</text>', svg):
        size = 9 * len(text), 13
        turned = "rotate(-90)" in attributes
        if turned:
            x, y = map(float, re.search(r'translate\(([\d.]+) ([\d.]+)\)', attributes).groups())
        else:
            x, y = (float(re.search(rf'\b{k}="([\d.]+)"', attributes).group(1)) for k in "xy")
        if 'told' not in attributes:
            continue
        end = "end" in attributes
        wide, high = (size[1], size[0]) if turned else size
        left = x - wide if turned or end else x
        top = (y if end else y - high) if turned else y - high
        boxes.append((left, top, left + wide, top + high))
    over += sum(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
                for i, a in enumerate(boxes) for b in boxes[:i])
print(arrows, crosses, over)
P

# One bump near its limit, the others far from it: all of them pass.
render foil 4 '{"radius_springback":{"mean":0.03,"sd":0.02}}'
"$program" measure foil.png -o foil.json
near_max=$(value foil.json 'max(b["radius_mm"] + 3 * b["u_radius_mm"] for b in r["foils"][0]["bumps"])')
near_min=$(value foil.json 'min(b["height_mm"] - 3 * b["u_height_mm"] for b in r["foils"][0]["bumps"])')
design pass "\"radius_mm\":{\"max\":$near_max},\"height_mm\":{\"min\":$near_min},\"radius_error_pct\":{\"max\":9},\"bump_angle_error_pct\":{\"max\":9}"
expect 0 '' "$program" measure foil.png -d pass.json -o a.json --html a.html
[ "$(python3 drawn.py a.html)" = "0 0 0" ] || fail "arrows, crosses, overlaps of a foil that passes: $(python3 drawn.py a.html)"
# Most of them fail, and both series have the same limit; two limits nearly coincide.
design fail '"radius_mm":{"max":3.34},"height_mm":{"min":0.56},"radius_error_pct":{"min":-0.3,"max":0.3},"bump_angle_error_pct":{"min":-0.3,"max":0.3}'
expect 1 '' "$program" measure foil.png -d fail.json -o a.json --html a.html
read -r arrows crosses over <<<"$(python3 drawn.py a.html)"
[ "$over" = 0 ] || fail "$over labels of a page lie over each other"
[ "$arrows" -gt 0 ] && [ "$crosses" -gt 0 ] || fail "arrows and crosses: $arrows, $crosses"
design none ''
expect 0 '' "$program" measure foil.png -d none.json -o a.json --html a.html
[ "$(python3 drawn.py a.html)" = "0 0 0" ] || fail "a foil without limits: $(python3 drawn.py a.html)"

# A lot: `near` has a bump 0.0086 mm from its limit, the others have 0.118 mm to spare at least.
mkdir scans
render scans/wide 5 '{"overall_radius_mm":20.8,"radius_springback":{"mean":0,"sd":0.001}}'
render scans/near 6 '{"overall_radius_mm":20.73,"radius_springback":{"mean":0.05,"sd":0.001}}'
render scans/last 7 '{"overall_radius_mm":20.74,"radius_springback":{"mean":0,"sd":0.001}}'
for name in wide near; do "$program" measure scans/$name.png -o $name.json; done
limit_r0=$(value wide.json 'r["foils"][0]["overall"]["radius_mm"] + 0.118')
limit_h=$(value near.json 'min(b["height_mm"] for b in r["foils"][0]["bumps"]) - 0.0086')
design lot "\"overall.radius_mm\":{\"max\":$limit_r0},\"height_mm\":{\"min\":$limit_h}"
expect 0 '' "$program" lot scans -d lot.json -o lot
[ "$(value lot/lot.json 'r["worst"][0]["label"]')" = near.png ] || fail "the worst is $(value lot/lot.json 'r["worst"][0]')"
near "the margin of the worst" "$(value lot/lot.json 'r["worst"][0]["worst_margin"]')" 0.0086 1e-6
[ "$(value lot/lot.json '[w["worst_quantity"] for w in r["worst"]]')" = "['height_mm', 'overall.radius_mm', 'overall.radius_mm']" ] ||
  fail "the worst three: $(value lot/lot.json '[w["worst_quantity"] for w in r["worst"]]')"

exit $failed
