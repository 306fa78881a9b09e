#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The second renderer's driver does as its members say, and the benchmark of drivers counts values that are silently wrong.
. tests/support/loop.sh
for python in python3 /usr/bin/python3 ""; do
  "$python" -c "import numpy" 2>/dev/null && break
done
[ -n "$python" ] || { echo "numpy is not on this machine"; exit 77; }

PYTHONPATH="$root/tests/bench" "$python" - <<'PYTHON' || fail "a stage of the second renderer's driver"
import numpy as np
import other_driver as driver

rng = np.random.default_rng(1)
picture = rng.uniform(0, 255, (24, 36)).astype(np.float32)

wide = np.pad(picture, 1, "edge")
near = [wide[i : i + 24, j : j + 36] for i in range(3) for j in range(3)]
assert np.array_equal(driver.median_3x3(picture), np.median(near, axis=0).astype(np.float32)), "median"

points = [[0, 0], [60, 20], [120, 200], [255, 255]]
at = np.linspace(0, 255, 400)
curve = driver.monotone_cubic(points, at)
assert np.all(np.diff(curve) >= 0), "a tone curve rises"
assert np.allclose(driver.monotone_cubic(points, [p[0] for p in points]), [p[1] for p in points]), "through its points"
numbers = driver.tone(picture, {"tone_curve": [[0, 0], [64, 0], [192, 255], [255, 255]]})
assert numbers.min() == 0 and numbers.max() == 255 and len(np.unique(numbers)) < 140, "clips, and leaves gaps"

ramp = np.tile(np.arange(40, dtype=np.float32) * 3, (12, 1))
for kind in ("linear", "cubic"):
    twice = driver.resample(ramp, 24, 80, kind)[12, 8:72]
    assert np.allclose(np.diff(twice), 1.5, atol=1e-4) and abs(twice[0] - 3 * (8.5 / 2 - 0.5)) < 1e-4, kind

assert len(driver.stitch(picture, [[0.5, 3]])) == 21 and len(driver.stitch(picture, [[0.5, -2]])) == 26, "rows"
assert np.array_equal(driver.stitch(picture, [[0.5, -2]])[10:16], picture[[10, 11, 10, 11, 12, 13]]), "rows come twice"

step = np.where(np.arange(40) < 20, 50, 150).astype(np.float32) * np.ones((12, 1), np.float32)
sharp = driver.sharpen(step, {"amount_pct": 100, "radius_px": 1})[6]
assert sharp.max() > 155 and sharp.min() < 45 and abs(sharp[5] - 50) < 1e-4, "overshoot beside the edge alone"
assert np.array_equal(driver.sharpen(step, {"amount_pct": 100, "radius_px": 1, "threshold": 60}), step), "threshold"

assert len(np.unique(driver.quantise(picture, {"levels": 16}))) == 16, "levels"
bit = driver.quantise(picture, {"levels": 2, "threshold": 100})
assert np.array_equal(bit, np.where(picture >= 100, 255, 0)), "1 bit"

dot = np.zeros((81, 81), np.float32)
dot[40, 40] = 1
blurred = driver.blur_ellipse(dot, [3.0, 1.0], 30).astype(float)
y, x = np.mgrid[-40:41, -40:41]
moments = [np.sum(blurred * v) for v in (x * x, x * y, y * y)]
c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
assert np.allclose(moments, [9 * c * c + s * s, 8 * c * s, 9 * s * s + c * c], atol=0.02), moments

block = np.zeros((60, 60), np.float32)
block[20:40, 20:40] = 1
lit = driver.cast_shadow(block, {"amplitude": -0.2, "direction_deg": 90, "length_px": 8, "gap_px": 0})
assert lit[42, 30] < -0.1 and lit[17, 30] == 0 and lit[30, 42] == 0 and np.all(lit[block == 1] == 1), "below alone"
PYTHON

[ -z "${FOILGAUGE_TEST_BRIEF-}" ] || exit $failed
"$python" "$root/tests/bench/driver.py" "$program" --quick --kinds unsharp --parts discs --variants "" --jobs 1 \
  -o page.md --csv values.csv >/dev/null 2>&1 || fail "driver.py"
"$python" - <<'PYTHON' || fail "rows of driver.py"
import csv
rows = list(csv.DictReader(open("values.csv")))
assert {r["kind"] for r in rows} == {"unsharp"} and {r["renderer"] for r in rows} == {"program", "other"}
assert all(r["quantity"] == "diameter" for r in rows) and len(rows) >= 12, len(rows)
close = [r for r in rows if r["value"] and abs(float(r["value"]) - float(r["true"])) < 0.03]
assert len(close) > len(rows) / 2, "the truth is that of what was drawn"
assert all(r["flagged"] == "1" for r in rows if not r["value"])
PYTHON

exit $failed
