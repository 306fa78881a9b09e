#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge forming` as the declared model of a loop: foils whose creep depends on the bump's number, which the model lacks.
. tests/support/loop.sh
skip_when_slow
listened="stdout stderr"
foils=8

# The declared model, and the truth: the same strip, but bumps near the lip creep less.
echo '{"schema": "foilgauge/material/1", "creep_rate_per_h": 0.0578, "creep_exponent": 4.61, "creep_energy_kj_per_mol": 130}' >strip.json
expect 0 "" "$program" forming --material strip.json --temperature 650 --time 5 -o declared.json
python3 - <<'END'
import json, math
strip = json.load(open("strip.json"))
for bump in range(1, 10):
    slow = dict(strip, creep_rate_per_h=strip["creep_rate_per_h"] * math.exp(-2 * math.exp(-(bump - 1) / 2)))
    json.dump(slow, open(f"slow_{bump}.json", "w"))
END
for bump in 1 2 3 4 5 6 7 8 9; do
  "$program" forming --material slow_$bump.json --temperature 650 --time 5 --table-out - | sed -n "$((bump + 1))p" >>truth.csv
done
mkdir lot
python3 - $foils <<'END'
import json, random, sys
rng = random.Random(1)
truth = [[float(cell) for cell in line.split(",")] for line in open("truth.csv")]
for number in range(int(sys.argv[1])):
    radii = [round(t[1] * (1 + rng.gauss(0, 0.0005)), 6) for t in truth]
    # the arc length stays that of the forming
    foil = {"radius_mm": radii, "bump_angle_deg": [t[1] * t[3] / r for t, r in zip(truth, radii)]}
    spec = {"schema": "foilgauge/render/1", "seed": number, "scanner": {"dpi": 900},
            "foils": [dict(foil, overall_radius_mm=20.9)]}
    json.dump(spec, open(f"spec_{number + 1}.json", "w"))
END
for i in $(seq $foils); do
  "$renderer" render spec_$i.json -o lot/$i.png || fail "render $i"
done
expect 0 "" "$renderer" lot lot -o out

expect 0 "" "$program" loop --lot out --form-model declared.json -o loop.json --html loop.html
valid loop.schema.json loop.json
checks - loop.json <<'END' || fail "the effect over the bumps is not found"
import json, sys
r = json.load(open(sys.argv[1]))
assert r["declared"]["offset"] == "declared" and any(i["path"] == "declared.json" for i in r["inputs"]), r["declared"]
assert r["verdict"] == "explained", r["verdict"]
assert [c["id"] for c in r["claims"]] == ["part.lip_decay"], r["claims"]
assert r["after"]["rms"] < 0.5 * r["before"]["rms"] and r["error_ratio"]["held_out"] < 0.6, r["error_ratio"]
END
grep -q 'offset(declared)' loop.html || fail "the page does not name the prediction"
grep -q 'measured minus predicted' loop.html || fail "the page does not say how far the prediction is off"

# The same on scans, beside one that is held out; the declared model is named everywhere.
scans="lot/1.png lot/2.png lot/3.png --hold-out lot/4.png"
expect 0 "" "$program" loop $scans --form-model declared.json -o scans.json --html scans.html
valid loop_scan.schema.json scans.json
checks - scans.json declared.json <<'END' || fail "the effect over the bumps of scans is not found"
import hashlib, json, sys
r = json.load(open(sys.argv[1]))
bumps = r["bumps"]
radius, angle, height = bumps["responses"]
assert bumps["declared"] == {"path": "declared.json", "sha256": hashlib.sha256(open(sys.argv[2], "rb").read()).hexdigest()}
assert r["verdict"] == "explained" and [(c["id"], c["response"]) for c in r["claims"]] == [("part.lip_decay", "bump_radius_mm")], r["claims"]
assert radius["rms_after"] < 0.6 * radius["rms_before"] and radius["held_out_rms_after"] < 0.7 * radius["held_out_rms_before"], radius
# On average the bumps are 3 um larger than one rate for all would have them.
assert abs(radius["level"] - 3) < 3 * radius["u_level"] and radius["u_level"] < 2, radius
assert angle["level"] is None and height["rms_before"] < 2, (angle, height)
END
grep -q 'declared of the bumps' scans.html && grep -q 'against the declared forming' scans.html ||
  fail "the page does not name the forming"
script -qec "$program loop $scans --form-model declared.json" /dev/null >terminal.txt 2>&1 || fail "the table of a loop on scans"
grep -q 'declared is what declared.json (foilgauge forming) predicts' terminal.txt && grep -q 'measured minus declared is' terminal.txt ||
  fail "the terminal does not name the forming"
expect 65 "loop.json: not a report of .foilgauge forming" "$program" loop lot/1.png --form-model loop.json
expect 74 "missing.json" "$program" loop lot/1.png --form-model missing.json
expect 64 "form-model is of the bumps of foils" "$program" loop lot/1.png --form discs --form-model declared.json
expect 64 "" "$program" loop lot/1.png --form-model declared.json -o declared.json
expect 64 "give a scan" "$program" loop --form-model declared.json
echo '{"schema": "foilgauge/design/1", "form": "classical", "bump_count": 6}' >six.json
expect 0 "" "$program" forming six.json -o six_form.json
expect 65 "six_form.json: it has no bump 7, which foil 1 of lot/1.png has" "$program" loop lot/1.png --form-model six_form.json

# A column of a table says the same as the report; what cannot be declared is refused.
printf 'foil,bump,radius_mm,declared\n' >table.csv
python3 -c "
import random
rng = random.Random(3)
for foil in range(1, 9):
    for bump in range(1, 10):
        print(f'{foil},{bump},{3.4 + 0.001 * bump + rng.gauss(0, 0.0006):.6f},{3.4 + 0.001 * bump:.6f}')" >>table.csv
expect 0 "" "$program" loop --table table.csv --response radius_mm --model 1 --group foil -o without.json
expect 0 "" "$program" loop --table table.csv --response radius_mm --model 1 --group foil --offset declared -o with.json
[ "$(value without.json "r['verdict'] != 'clean' and len(r['claims'])")" = 1 ] || fail "the trend over the bumps is not seen"
[ "$(value with.json "r['verdict']")" = clean ] || fail "what was declared is found again: $(value with.json "r['verdict']")"
near "rms of what is left" "$(value with.json "r['before']['rms']")" 0.0006 0.0001
expect 65 "quantities of a bump, and 'foil' is none" "$program" loop --table table.csv --response foil --model 1 --form-model declared.json
expect 65 "no column 'bump'|bump" "$program" loop --table "$root/samples/doe/springback_composite.csv" \
  --response springback_error_pct --model 1 --form-model declared.json
expect 65 "loop.json: not a report of .foilgauge forming" "$program" loop --lot out --form-model loop.json
expect 64 "drop --offset" "$program" loop --table table.csv --response radius_mm --model 1 --form-model declared.json --offset declared
expect 64 "cannot be its own prediction" "$program" loop --table table.csv --response radius_mm --model 1 --offset radius_mm
expect 64 "" "$program" loop --lot out --form-model declared.json -o declared.json
sed 's/^1,3,/1,12,/' table.csv | cut -d, -f1-3 >odd.csv
expect 65 "declared.json: it has no bump 12" "$program" loop --table odd.csv --response radius_mm --model 1 --form-model declared.json
exit $failed
