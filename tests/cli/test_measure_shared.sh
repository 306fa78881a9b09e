#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge measure` on scans of a renderer that is not this project's, against their truth.
shared=$(realpath -m "${FOILGAUGE_SHARED:-../shared}")/scans
if [ ! -e "$shared/p1_classical.png" ] || ! command -v python3 >/dev/null; then
  echo "skipped: no $shared/p1_classical.png, or no python3"
  exit 77
fi
. tests/support/cli.sh

# compare NAME R_UM HEIGHT_UM: the largest errors that are allowed.
compare() {
  "$program" measure "$shared/$1.png" -d "$shared/$4.design.json" -o "$work/$1.json" || return 1
  python3 - "$work/$1.json" "$shared/$1.truth.json" "$2" "$3" <<'PYTHON'
import json, math, sys
report, truth = (json.load(open(path)) for path in sys.argv[1:3])
radius_um, height_um = map(float, sys.argv[3:5])
foil, = report["foils"]
true = truth["bumps"]
bad = []
if len(foil["bumps"]) != len(true):
    sys.exit("%d bumps, not %d" % (len(foil["bumps"]), len(true)))
# Without a lip numbers go clockwise, which may be backwards.
radii = [b["radius_mm"] for b in foil["bumps"]]
if "no_lip" in foil["flags"]:
    there = sum((a - b["radius_mm"]) ** 2 for a, b in zip(radii, true))
    back = sum((a - b["radius_mm"]) ** 2 for a, b in zip(radii[::-1], true))
    if back < there:
        true = true[::-1]
limits = {"radius_mm": radius_um, "height_mm": height_um}
for bump, t in zip(foil["bumps"], true):
    for name, limit in limits.items():
        error = 1000 * (bump[name] - t[name])
        if not abs(error) <= limit:
            bad.append("bump %d %s off by %.3f um" % (bump["number"], name, error))
        if not abs(error) <= 5000 * bump["u_" + name]:
            bad.append("bump %d %s off by %.1f u" % (bump["number"], name,
                                                     error / 1000 / bump["u_" + name]))
error = 1000 * (foil["overall"]["radius_mm"] - truth["overall_radius_mm"])
if not abs(error) <= radius_um:
    bad.append("R0 off by %.3f um" % error)
for line in bad:
    print(line)
sys.exit(len(bad) > 0)
PYTHON
}

while read -r name radius height design; do
  compare "$name" "$radius" "$height" "$design" || fail "$name"
done <<'TABLE'
p1_classical 0.4 0.1 gen2
p2_dark_on_light 0.4 0.1 gen2
p3_sinusoidal_16bit 0.4 0.1 sinusoidal
p4_lip_springback 0.4 0.1 gen2
p7_rough 20 2 gen2
TABLE
exit $failed
