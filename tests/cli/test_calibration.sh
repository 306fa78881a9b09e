#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Uncertainty beyond the statistics: a calibration in the design or the recipe enters every U, verdicts, lots and loops;
# and a report states its traceability in the same words on every page.
#   test_calibration.sh PROGRAM
. tests/support/cli.sh
skip_when_slow # test_traceability.sh sees the same code

for turn in 0 40 75; do
  cat >r.json <<J
{"schema": "foilgauge/render/1", "seed": 4$turn, "foils": [{"rotate_deg": $turn, "radius_springback": {"mean": 0.02, "sd": 0.007}}],
 "scanner": {"dpi": 1200, "blur_px": 1.1, "noise": 1.0}}
J
  mkdir -p scans
  "$renderer" render r.json -o scans/s$turn.png || fail "render"
done
scan=scans/s40.png
scale='"calibration": {"certificate": "K 17 <b>", "date": "2026-03-14", "scale": {"U_rel": 1e-3, "k": 2}}'
warm='"calibration": {"scale": {"u_rel": 5e-4}, "temperature": {"value_C": 30, "u_K": 1}, "expansion": {"value_per_K": 2e-5, "u_per_K": 2e-6}}'
limits='"tolerances": {"overall.radius_mm": {"min": 20.71, "max": 20.75}}'
design() {
  echo "{\"schema\": \"foilgauge/design/1\", \"name\": \"d\", \"tone\": \"linear\"$1}" >"$2"
}
design '' plain.json
design ", $scale" scale.json
design ", $warm" warm.json
design ", $limits, \"calibration\": \"not needed: rendered\"" limits.json
design ", $limits, $scale" both.json
for d in plain scale warm; do
  expect 0 '' "$program" measure $scan --design $d.json -o $d.out --html $d.html
  valid measure.schema.json $d.out
done
checks - <<'P' || fail "u and values"
import json
read = lambda name: json.load(open(name + ".out"))
plain, scale, warm = read("plain"), read("scale"), read("warm")
assert plain["calibration"] is None and scale["calibration"]["scale"] == {"u_rel": 5e-4}
a, b, c = (r["foils"][0] for r in (plain, scale, warm))
r0 = a["overall"]["radius_mm"]
assert b["overall"]["radius_mm"] == r0
u = (a["overall"]["u_radius_mm"] ** 2 + (5e-4 * r0) ** 2) ** 0.5
assert abs(b["overall"]["u_radius_mm"] / u - 1) < 1e-4
assert abs(c["overall"]["radius_mm"] / r0 - (1 - 2e-4)) < 1e-6
# GUM 5.1.2: the pitch, (T - 20) u_alpha, alpha u_T
rel = (5e-4 ** 2 + (10 * 2e-6) ** 2 + (2e-5 * 1) ** 2) ** 0.5
assert abs(warm["calibration"]["u_rel"]["length"][0] / rel - 1) < 1e-9
assert abs(c["overall"]["u_radius_mm"] / (rel * r0) - 1) < 1e-3
for x, y in zip(a["bumps"], c["bumps"]):
    assert abs(x["bump_angle_deg"] - y["bump_angle_deg"]) < 1e-3 and abs(x["u_bump_angle_deg"] / y["u_bump_angle_deg"] - 1) < 0.05
for line in warm["calibration"]["budget"]:
    assert abs(line["u"] ** 2 - line["u_statistical"] ** 2 - line["u_calibration"] ** 2) < 1e-6 * line["u"] ** 2
assert any(line["quantity"] == "clearance_mm" and line["u_calibration"] > 0 for line in warm["calibration"]["budget"])
P

# R0 lies 20 um within its limits: enough for statistics, within U of a scale that is known to 0.1 %.
expect 0 '' "$program" measure $scan --design limits.json -o sure.out
expect 3 '' "$program" measure $scan --design both.json -o unsure.out
[ "$(value unsure.out 'r["verdict"]')" = cannot_tell ] || fail "the limit lies within U"

# Traceability on every page: that no calibration is stated, or the certificate.
grep -q 'No calibration is stated: U holds statistics only' plain.html || fail "the page is silent about calibration"
grep -q '<dt>Calibration</dt><dd>K 17 &lt;b&gt; of 2026-03-14: a length to ± 0.1 %' scale.html || fail "the certificate is not named"
script -qec "'$program' measure $scan" /dev/null >plain.txt 2>/dev/null
[ "$(grep -c 'No calibration' plain.txt)" = 1 ] || fail "the terminal says it once: $(grep -c 'No calibration' plain.txt)"

# A place for each fault.
design ', "calibration": {"scale": {"u_rel": 1e-4, "k": 2}}' bad.json
expect 65 'bad.json: calibration.scale: k belongs to U_rel' "$program" measure $scan --design bad.json -o never
[ -e never ] && fail "a refused design leaves a report"

# A lot: the recipe overrules the design; no number of foils makes it smaller; the same bytes however it came.
echo "{\"schema\": \"foilgauge/recipe/1\", \"calibration\": {\"scale\": {\"u_rel\": 2e-3}}, \"design\": \"scale.json\", \"assembly\": {\"bearings\": 0}}" >recipe.json
expect 0 '' "$program" lot scans --name calibrated --recipe recipe.json -o lot
expect 0 '' "$program" lot scans --name calibrated --recipe recipe.json -o one --shard 1/2
expect 0 '' "$program" lot scans --name calibrated --recipe recipe.json -o two --shard 2/2
expect 0 '' "$program" merge one two -o merged
cp -r lot before
expect 0 '' "$program" lot scans --name calibrated --recipe lot/recipe.json -o lot --resume
for file in lot.json index.html bumps.csv; do
  same lot/$file before/$file
  same lot/$file merged/$file
done
valid lot.schema.json lot/lot.json
expect 0 '' "$program" lot scans --design plain.json -o bare
checks - <<'P' || fail "the lot"
import json
a, b = (json.load(open(d + "/lot.json")) for d in ("lot", "bare"))
assert a["calibration"]["scale"]["u_rel"] == 2e-3 and b["calibration"] is None
q, p = a["quantities"]["overall.radius_mm"], b["quantities"]["overall.radius_mm"]
assert abs(q["u_mean_calibration"] / q["mean"] - 2e-3) < 1e-6 and p["u_mean_calibration"] == 0
assert abs(q["u_mean"] ** 2 - q["u_mean_statistical"] ** 2 - q["u_mean_calibration"] ** 2) < 1e-6 * q["u_mean"] ** 2
assert abs(q["u_mean_statistical"] / p["u_mean_statistical"] - 1) < 0.01
assert abs(a["quantities"]["overall.radius_mm"]["sd"] - b["quantities"]["overall.radius_mm"]["sd"]) < 1e-9
# A bearing's circularity is a difference of clearances: of a scale it takes a relative share, and no more.
c, d = a["bearings"][0], b["bearings"][0]
assert c["u_mean_mm"] > 1.1 * d["u_mean_mm"] and c["u_circularity_mm"] < 2 * d["u_circularity_mm"], (c["u_circularity_mm"], d["u_circularity_mm"])
# Stiffness over the design's is of ratios t / R: a scale leaves it.
assert a["stiffness"]["u_normalised_by_calibration"] < 1e-4
P
# Capability holds limits against a mean that all foils' common error moves: its intervals hold that error, and are missing where
# nothing is known of the scale.
room='"tolerances": {"radius_mm": {"min": 3.3, "max": 3.5}}'
design ", $room, \"calibration\": \"not needed: rendered\"" known.json
design ", $room, \"calibration\": {\"scale\": {\"u_rel\": 2e-3}}" wide.json
design ", $room" unknown.json
for d in known wide unknown; do
  "$program" lot scans --name d --design $d.json --pages none -o lot_$d >/dev/null 2>&1
done
checks - <<'P' || fail "capability and the calibration"
import json, math
known, wide, unknown = (json.load(open(f"lot_{d}/lot.json"))["quantities"]["radius_mm"] for d in ("known", "wide", "unknown"))
a, b, c = (q["capability"]["ppk"] for q in (known, wide, unknown))
reach = 1.959964 * wide["u_mean"] / (3 * wide["sd"])
assert reach > 0.1 and abs(a["value"] - b["value"]) < 1e-6, (reach, a, b)
assert abs(b["value"] - b["low"] - math.hypot(a["value"] - a["low"], reach)) < 1e-3, (reach, a, b)
high = min(b["value"] + math.hypot(a["high"] - a["value"], reach), max(a["high"], wide["capability"]["pp"]["high"]))
assert abs(b["high"] - high) < 1e-3, (reach, a, b)
assert c["low"] is None and c["high"] is None and c["value"] > 0, c
P
grep -q 'How well the means are known' lot/index.html || fail "the lot's page has no line of the calibration"
grep -q 'no calibration is stated' bare/index.html || fail "the lot's page does not say that none is stated"
expect 0 '' "$program" lot --index index.html lot bare
for page in plain.html scale.html lot/index.html index.html; do
  grep -q "<dt>Date</dt><dd>$(date -u -r $scan +%F)" "$page" || fail "$page: no date"
  grep -q '<dt>Program</dt><dd>foilgauge ' "$page" || fail "$page: no program"
  grep -q '<dt>Design</dt><dd>\(<[^>]*>\)\?d\(</[a-z]*>\)\? (classical), SHA-256 ' "$page" || fail "$page: no design"
  grep -q '<dt>Calibration</dt><dd>' "$page" || fail "$page: no calibration"
done
expect 0 '' "$program" design plain.json --html design.html -o design.out
grep -q '<dt>Design</dt><dd>\(<[^>]*>\)\?d\(</[a-z]*>\)\? (classical), SHA-256 ' design.html || fail "design.html: no design"

# A design says its calibration; without one, that there is none.
for d in scale warm plain; do
  expect 0 '' "$program" design $d.json --html $d.design.html
  "$program" design $d.json >$d.design
done
grep -q 'K 17 <b> of 2026-03-14' scale.design && grep -q 'scale, U = 2 u .* x 0.1 %, y 0.1 % (one error of both)' scale.design ||
  fail "the design's table has no calibration: $(grep -A4 '^calibration' scale.design)"
grep -q 'scanned at .* 30 C, U 2 K: 0.004 % of a length' warm.design || fail "the design's temperature: $(grep -A6 '^calibration' warm.design)"
grep -q 'none is stated' plain.design || fail "the design does not say that none is stated"
grep -q '<dt>Calibration</dt><dd>K 17' scale.design.html && grep -q '<dt>Calibration</dt><dd>none is stated' plain.design.html ||
  fail "the design's page is silent about calibration"

# An experiment: its runs share the error, which is in the level and in no effect.
printf 'T,scan\n-1,s0.png\n-1,s40.png\n1,s75.png\n' >scans/runs.csv
for d in plain scale; do
  expect 0 '' "$program" doe scans/runs.csv --scans scan --design $d.json --response overall.radius_mm --model T -o doe_$d.out --html doe_$d.html
done
valid doe.schema.json doe_plain.out doe_scale.out
checks - <<'P' || fail "an experiment's calibration"
import json
a, b = (json.load(open(f"doe_{d}.out")) for d in ("plain", "scale"))
assert a["calibration"] is None and a["u_calibration"] is None
level = sum(i["value"] for i in b["inputs"][1:]) / 3
assert abs(b["u_calibration"] / (5e-4 * level) - 1) < 1e-3, (b["u_calibration"], level)
assert a["coefficients"] == b["coefficients"] and [i.get("u") for i in a["inputs"]] == [i.get("u") for i in b["inputs"]]
assert any("the same in every scan" in c for c in b["conclusions"]) and any("No calibration is stated" in c for c in a["conclusions"])
P
grep -q 'the same in every scan' doe_scale.html || fail "the experiment's page does not say what its calibration does"

[ -n "${FOILGAUGE_TEST_LONG-}" ] || exit $failed
# A loop: its decisions ignore the calibration, the dimensions that it reports include it.
for d in plain scale; do
  expect 0 '' "$program" loop $scan --design $d.json -o loop_$d.out --html loop.html
  valid loop_scan.schema.json loop_$d.out
done
grep -q '<dt>Calibration</dt><dd>K 17' loop.html || fail "the loop's page does not name it"
checks - <<'P' || fail "the loop"
import json
a, b = (json.load(open(f"loop_{d}.out")) for d in ("plain", "scale"))
for name in ("verdict", "p_value", "noise_floor", "claims", "rejected", "error_ratio"):
    assert a[name] == b[name], name
for side in ("before", "after"):
    x, y = (r[side]["foils"][0]["bumps"][3] for r in (a, b))
    assert x["radius_mm"] == y["radius_mm"]
    assert abs(y["u_radius_mm"] ** 2 - x["u_radius_mm"] ** 2 - (5e-4 * x["radius_mm"]) ** 2) < 1e-3 * y["u_radius_mm"] ** 2
P
exit $failed
