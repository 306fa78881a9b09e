#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The measurand in the truth of a render is the one by which the benches judge: circles through the part as it is, found by
# code that has nothing in common with the program's.
. tests/support/loop.sh
for python in python3 /usr/bin/python3 ""; do
  "$python" -c "import numpy" 2>/dev/null && break
done
[ -n "$python" ] || { echo "numpy is not on this machine"; exit 77; }

cat >compare.py <<'PYTHON'
import json, subprocess, sys

sys.path.insert(0, sys.argv[1] + "/tests/bench")
import numpy as np
from loop_cases import draw_case
from loop_run import true_foils

rng = np.random.default_rng(4)
KINDS = ["part.ovality", "part.spiral", "part.bump_crown", "part.bump_skew", ("foil.s", None), ("bump.phi", None), "scan.shear"]
for kind in KINDS:
    case = draw_case(rng, "single", 1, [kind], 10.0)
    spec = case["specs"][0]
    spec["scanner"] = {"dpi": 600}  # the truth does not depend on it; pixels are few
    del spec["width_px"], spec["height_px"]
    with open("spec.json", "w", encoding="utf-8") as out:
        json.dump(spec, out)
    subprocess.run([sys.argv[2], "render", "spec.json", "-o", "drawn.png", "--truth", "drawn.json"], check=True)
    with open("drawn.json", encoding="utf-8") as text:
        truth = json.load(text)
    own = true_foils(case)[0][0].measurand
    of = lambda name: np.array([b["measurand"][name] for b in truth["bumps"]])
    pairs = {"R0": (1000 * own.overall, 1000 * truth["measurand"]["radius_mm"], 0.1),
             "R": (1000 * own.radius, 1000 * of("radius_mm"), 0.2), "h": (1000 * own.height, 1000 * of("height_mm"), 0.1),
             "form error of lands": (own.overall_form_um, truth["measurand"]["form_error_um"], 0.05),
             "form errors": (own.form_um, of("form_error_um"), 0.05)}  # fmt: skip
    for name, (a, b, most) in pairs.items():
        assert np.max(np.abs(np.subtract(a, b))) < most, (kind, name, a, b)
    deformed = max(own.overall_form_um, *own.form_um) > 1
    assert deformed != (kind == "scan.shear"), (kind, own)
PYTHON
"$python" compare.py "$root" "$renderer" || fail "the truth's measurand is not that of the benches"

exit $failed
