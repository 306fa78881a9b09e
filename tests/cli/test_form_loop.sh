#!/bin/bash
# `foilgauge form` as the declared model of a loop: foils whose creep depends on the bump's number, which the model lacks.
. tests/support/loop.sh
skip_when_slow
listened="stdout stderr"
foils=8

# The declared model, and the truth: the same strip, but bumps near the lip creep less.
echo '{"schema": "foilgauge/material/1", "creep_rate_per_h": 0.0578, "creep_exponent": 4.61, "creep_energy_kj_per_mol": 130}' >strip.json
expect 0 "" "$program" form --material strip.json --temperature 650 --time 5 -o declared.json
python3 - <<'END'
import json, math
strip = json.load(open("strip.json"))
for bump in range(1, 10):
    slow = dict(strip, creep_rate_per_h=strip["creep_rate_per_h"] * math.exp(-2 * math.exp(-(bump - 1) / 2)))
    json.dump(slow, open(f"slow_{bump}.json", "w"))
END
for bump in 1 2 3 4 5 6 7 8 9; do
  "$program" form --material slow_$bump.json --temperature 650 --time 5 --table-out - | sed -n "$((bump + 1))p" >>truth.csv
done
mkdir lot
python3 - $foils <<'END'
import json, random, sys
rng = random.Random(1)
truth = [float(line.split(",")[1]) for line in open("truth.csv")]
for foil in range(int(sys.argv[1])):
    spec = {"schema": "foilgauge/render/1", "seed": foil, "scanner": {"dpi": 900},
            "foils": [{"overall_radius_mm": 20.9, "radius_mm": [round(r * (1 + rng.gauss(0, 0.0005)), 6) for r in truth]}]}
    json.dump(spec, open(f"spec_{foil + 1}.json", "w"))
END
for i in $(seq $foils); do
  "$renderer" render spec_$i.json -o lot/$i.png || fail "render $i"
done
expect 0 "" "$renderer" lot lot -o out

expect 0 "" "$program" loop --lot out --form-model declared.json -o loop.json --html loop.html
valid loop.schema.json loop.json
python3 - loop.json <<'END' || fail "the effect over the bumps is not found"
import json, sys
r = json.load(open(sys.argv[1]))
assert r["declared"]["offset"] == "declared" and any(i["path"] == "declared.json" for i in r["inputs"]), r["declared"]
assert r["verdict"] == "explained", r["verdict"]
assert [c["id"] for c in r["claims"]] == ["part.lip_decay"], r["claims"]
assert r["after"]["rms"] < 0.5 * r["before"]["rms"] and r["error_ratio"]["held_out"] < 0.6, r["error_ratio"]
END
grep -q 'offset(declared)' loop.html || fail "the page does not name the prediction"
grep -q 'measured minus predicted' loop.html || fail "the page does not say how far the prediction is off"

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
expect 65 "loop.json: not a report of .foilgauge form" "$program" loop --lot out --form-model loop.json
expect 64 "drop --offset" "$program" loop --table table.csv --response radius_mm --model 1 --form-model declared.json --offset declared
expect 64 "cannot be its own prediction" "$program" loop --table table.csv --response radius_mm --model 1 --offset radius_mm
expect 64 "" "$program" loop --lot out --form-model declared.json -o declared.json
sed 's/^1,3,/1,12,/' table.csv | cut -d, -f1-3 >odd.csv
expect 65 "declared.json: it has no bump 12" "$program" loop --table odd.csv --response radius_mm --model 1 --form-model declared.json
exit $failed
