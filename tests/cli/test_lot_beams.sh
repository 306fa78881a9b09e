#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A lot of cantilevers: statistics and files name beams; records keep them; who cannot do with them says so.
. tests/support/cli.sh
skip_when_slow # test_lot.sh and test_beams.sh see the same code
listened="stdout stderr"

cat >design.json <<'J'
{"schema": "foilgauge/design/1", "form": "cantilever", "beam_count": 4, "beam_length_mm": 4, "beam_width_mm": 1, "thickness_mm": 0.1,
 "sagitta_mm": 0.5, "clearance_mm": 0.1, "elastic_modulus_gpa": 214, "calibration": "not needed: the scan is rendered", "tolerances": {"compliance_error_pct": {"min": -9, "max": 9}}}
J
# sheet NAME SEED LONGER [BEAMS]: a foil whose beams are longer by so many um.
mkdir lot
sheet() {
  cat >"$1.spec" <<J
{"schema": "foilgauge/render/1", "seed": $2, "scanner": {"dpi": 1200}, "foils": [{"design": {"form": "cantilever", "beam_count": 4,
 "beam_length_mm": 4, "beam_width_mm": 1, "thickness_mm": 0.1}, "beams": {"pitch_mm": 1.8, "base_mm": 1.5, "shoulder_mm": 0.8,
 "length": {"mean_um": $3, "sd_um": 8}, "width": {"mean_um": -5, "sd_um": 6}${4-}}, "rotate_deg": -88}]}
J
  "$renderer" render "$1.spec" -o "$1.png" --truth "$1.truth" || fail "render $1"
}
echo "scan,foil,die,date" >manifest.csv
for i in 1 2 3 4 5 6; do
  sheet lot/f$i $i $((i % 2 ? 0 : 40))
  echo "lot/f$i.png,f$i,$([ $((i % 2)) = 1 ] && echo A || echo B),2026-11-0$i" >>manifest.csv
done
run() { "$program" lot manifest.csv --name combs --design design.json --group die "$@"; }
expect 0 "6 foils of 6 scans: 6 pass" run -o one
valid lot.schema.json one/lot.json
[ -e one/bumps.csv ] || [ -e one/bearings.csv ] && fail "files of bumps beside those of beams"
[ "$(wc -l <one/beams.csv)" = 25 ] || fail "beams.csv"
checks - <<'P' || fail "the lot's numbers"
import csv, json, statistics
r = json.load(open("one/lot.json"))
truth = [b for i in range(1, 7) for b in json.load(open(f"lot/f{i}.truth"))["beams"]]
assert r["counts"]["beams"] == 24 and r["counts"]["beams_damaged"] == 0 and "bumps" not in r["counts"]
for name, within in (("length_mm", 1e-3), ("width_mm", 1e-3), ("compliance_error_pct", 0.1)):
    q, t = r["quantities"][name], [b[name] for b in truth]
    assert abs(q["mean"] - statistics.mean(t)) < within and abs(q["sd"] - statistics.stdev(t)) < within, (name, q["mean"], q["sd"])
    assert [p["number"] for p in q["beams"]] == [1, 2, 3, 4] and "bumps" not in q, name
assert r["quantities"]["compliance_error_pct"]["capability"]["ppk"]["value"] > 0.5
assert "worst_beam" in r["foils"][0] and "stiffness" not in r and "bearings" not in r and "nominal" not in r
dies = next(c for c in r["comparisons"] if c["quantity"] == "length_mm")
# Three foils of each die, which are the unit, not their twelve beams.
assert abs(dies["difference"]) > 0.03 and dies["p_means"] < 1e-2 and dies["foils_a"] == 3, dies
beams = list(csv.DictReader(open("one/beams.csv")))
assert [b["beam"] for b in beams[:5]] == ["1", "2", "3", "4", "1"] and abs(float(beams[0]["length_mm"]) - truth[0]["length_mm"]) < 2e-3
P
grep -q "beam, from left to right" one/index.html || fail "the page has no beams"
grep -q "Compliance and sagitta" one/index.html || fail "the page has no section of compliance"
python3 -c 'import re; t = re.sub("<style>.*?</style>", "", open("one/index.html").read(), flags=re.S)
assert not re.search("bump|springback|bearing", t, re.I), re.search(".{40}(bump|springback|bearing).{40}", t, re.I | re.S)' ||
  fail "the page of beams speaks of bumps"
grep -q "<Name>length from the root line to the tip, beam 3</Name>" one/results.qif || fail "results.qif"
python3 -c 'import xml.dom.minidom; xml.dom.minidom.parse("one/results.qif")' || fail "results.qif is not well-formed"
grep -q "K2002/3 length from the root line to the tip, beam 3" one/results.dfq || fail "results.dfq"

# Resumed from its records, in shards, with a record damaged: the same.
cp -r one resumed
rm resumed/index.html resumed/beams.csv resumed/lot.json
expect 0 "" run -o resumed --resume
same one resumed
for i in 1 2; do expect 0 "" run -o shards/$i --shard $i/2; done
expect 0 "6 foils" "$program" merge shards/* -o merged
same one merged
sed -i '3s/"number"/"nunber"/' resumed/results.jsonl
expect 0 "" run -o resumed --resume
cmp one/beams.csv resumed/beams.csv || fail "a damaged record of beams"

# Torn, and out of tolerance.
sheet lot/f7 7 0 ', "torn": [{"beam": 2, "length_factor": 0.7}]'
sheet lot/f8 8 300
printf 'lot/f7.png,f7,A,2026-11-07\nlot/f8.png,f8,B,2026-11-08\n' >>manifest.csv
run -o bad >stdout 2>stderr
code=$?
[ $code = 1 ] || [ $code = 2 ] || fail "the exit code of a lot with a torn beam and long ones is $code: $(cat stdout stderr)"
valid lot.schema.json bad/lot.json
checks - <<'P' || fail "damaged beams"
import json
r = json.load(open("bad/lot.json"))
assert r["counts"]["beams_damaged"] == 1 and r["counts"]["fail"] >= 1, r["counts"]
assert r["worst"][0]["label"] in ("f7", "f8") and r["quantities"]["length_mm"]["count"] == 31, r["quantities"]["length_mm"]["count"]
P

# Lots beside each other, a lot as a table, an experiment of scans.
expect 0 "" "$program" lot --index index.html -o index.json one bad
valid lot_index.schema.json index.json
checks - <<'P' || fail "lots of beams beside each other"
import json
r = json.load(open("index.json"))
assert not any(l.get("problem") or l.get("doubt") for l in r["lots"]), r["lots"]
P
"$program" loop --lot one --response length_mm --model 1 -o loop.json || [ $? = 3 ] || fail "the loop on a lot of beams"
expect 65 "'radius_mm' is no quantity that a lot holds; there are: length_mm" "$program" loop --lot one --response radius_mm --model 1
(
  echo "D,scan"
  for i in 1 2 3 4 5 6; do echo "$((i % 2)),lot/f$i.png"; done
) >runs.csv
expect 0 "" "$program" doe runs.csv --scans scan --design design.json --response length_mm --model '1 + D' -o doe.json
near "half of the dies' difference" "$(value doe.json 'next(t["estimate"] for t in r["coefficients"] if t["name"] == "D")')" -0.02 0.006
expect 65 "is no quantity that a scan gives; there are: .*length_mm" "$program" doe runs.csv --scans scan --design design.json \
  --response height_mm --model '1 + D'
mkdir watched
expect 65 "design.form is cantilever: a station keeps" "$program" station watched --design design.json --once
exit $failed
