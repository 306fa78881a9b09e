#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge film`: its outputs, measured foils, random shims, bad input. Its numbers: unit/test_film.c.
. tests/support/cli.sh
listened="stdout stderr"
fast="--load 20 --speed 60000 --clearance 40 --compliance 0.67 --mesh 2,4"

echo '{"schema": "foilgauge/design/1", "name": "<b>&"}' >design.json
expect 0 "" "$program" film design.json $fast --speeds 30000:90000:4 --shims=-7:7 --draws 25 -o film.json --html film.html --table film.txt \
  --speeds-out speeds.csv --draws-out draws.csv
grep -q '&lt;b&gt;&amp;' film.html && ! grep -q '<b>&' film.html || fail "a name is not made harmless"
for words in 'Critical mass' 'Pressure of the unwrapped film' 'shims of -7 to 7' 'stiffness, N/µm' '<dt>Program</dt>'; do
  grep -q "$words" film.html || fail "the page lacks $words"
done
[ "$(wc -l <speeds.csv)" = 5 ] && [ "$(wc -l <draws.csv)" = 26 ] || fail "rows of the tables"
valid film.schema.json film.json

# The field balances the load: pressure over the film against 20 N towards 270 degrees.
checks - film.json <<'END' || fail "the report"
import json, math, sys
r = json.load(open(sys.argv[1]))
c, force = r["conditions"], [0, 0]
step, dz = math.radians(r["field"][1]["angle_deg"] - r["field"][0]["angle_deg"]), c["length_mm"] / 8
for column in r["field"]:
    p = [x - c["ambient_kpa"] for x in column["pressure_kpa"]]
    mean = dz * (p[0] / 2 + sum(p[1:-1]) + p[-1] / 2) * 2 * c["diameter_mm"] / 2 * step * 1e-3
    force[0] += mean * math.cos(math.radians(column["angle_deg"]))
    force[1] += mean * math.sin(math.radians(column["angle_deg"]))
    assert abs(column["clearance_um"] - 40) < 1e-9
assert abs(force[0]) < 1e-4 and abs(force[1] + 20) < 1e-4, force
assert min(x["film_um"] for x in r["field"]) == r["bearing"]["min_film_um"]
d = r["draws"]
assert d["solved"]["count"] == 25 and d["more_stable"]["count"] + d["less_stable"]["count"] == 25, d
assert 0 <= d["mass_over_perfect"]["at_5_pct"] < 1 < d["mass_over_perfect"]["at_75_pct"], d
assert r["coefficients"][10]["whirl_ratio"] == 1
END

# Eigenvalues of rotor and film: the least stable one crosses at the threshold of the critical mass, which is solved for to 1e-4, as is
# theirs; it grows where the rotor is heavier than that, and the whirl is that of the critical mass beside the threshold.
expect 0 "whirls of the rotor on its film" "$program" film design.json --load 20 --speed 14000 --clearance 32 --compliance 0.67 --mass 0.3 \
  --speeds 8000:40000:12 --mesh 2,4 -o whirls.json --html whirls.html --table -
valid film.schema.json whirls.json
grep -q 'Whirls of the rotor on its film' whirls.html || fail "the page lacks the whirls"
checks - whirls.json <<'END' || fail "eigenvalues"
import json, math, sys
r = json.load(open(sys.argv[1]))
assert 12000 < r["threshold_rpm"] < 16000 and abs(r["threshold_eigen_rpm"] / r["threshold_rpm"] - 1) < 2e-4, r
for speed in [r["bearing"], *r["speeds"]]:
    assert (speed["log_decrement"] > 0) == (speed["stability"] == "stable"), speed
least = r["eigenvalues"][0]
assert least["log_decrement"] == r["bearing"]["log_decrement"] == min(e["log_decrement"] for e in r["eigenvalues"])
for e in r["eigenvalues"]:
    angle = math.atan2(e["log_decrement"], 2 * math.pi)
    assert math.isclose(math.sin(angle), e["damping_ratio"], rel_tol=1e-6) and e["stable"] == (e["damping_ratio"] > 0), e
    assert math.isclose(e["frequency_hz"], e["whirl_ratio"] * 14000 / 60, rel_tol=1e-6)
assert least["direction"] == "forward" and math.isclose(least["whirl_ratio"], r["bearing"]["whirl_ratio"], rel_tol=0.02)
END

# No rotor is light enough for a film whose equivalent stiffness is below 0, nor for one that it falls off: eigenvalues agree.
expect 0 "" "$program" film design.json --load 20 --speed 20000 --clearance 80 --compliance 0.67 --touching 13 --mesh 6,8 \
  --speeds 16837:19500:8 -o every.json
checks - every.json <<'END' || fail "rotors of every mass"
import json, sys
r = json.load(open(sys.argv[1]))
for s in r["speeds"]:
    assert (s["critical_mass_kg"] == 0) == (s["stability"] == "unstable at every mass"), s
    assert (s["log_decrement"] is None) == (s["whirl_ratio"] == 0) and not (s["log_decrement"] or -1) > 0, s
words = [s["stability"] for s in r["speeds"] if s["whirl_ratio"] != 0]
assert {"unstable at every mass", "unstable"} == set(words) and len(words) < 8, words
END
# A threshold below lift-off.
expect 0 "whirls as soon as it has lifted off" "$program" film --load 5 --speed 20000 --touching 20 --mesh 2,4 --speeds 3000:20000:9 -o whirls.json --table -
checks - whirls.json <<'END' || fail "a threshold below lift-off"
import json, sys
r = json.load(open(sys.argv[1]))
assert r["threshold_rpm"] < r["lift_off_rpm"] < 12000 and r["speeds"][0]["outcome"] == "touching", r
END
# The map of speeds moves no limit of the bearing: the search for limits begins at its own film.
expect 0 "" "$program" film design.json --load 40 --speed 60000 --mesh 2,4 --speeds 50000:70000:2 -o few.json
expect 0 "" "$program" film design.json --load 40 --speed 60000 --mesh 2,4 --speeds 30000:240000:9 -o many.json
checks - <<'END' || fail "limits hang on the map of speeds"
import json
few, many = (json.load(open(name)) for name in ("few.json", "many.json"))
assert few["load_capacity_n"] > 41 and few["lift_off_rpm"] < 55000, few
assert (few["load_capacity_n"], few["lift_off_rpm"]) == (many["load_capacity_n"], many["lift_off_rpm"])
END

# Two films under one load: the load capacity is that of either, and a heavier rotor lifts off no earlier.
few="--mesh 2,4 --speeds 5000:5100:2"
for at in 5_5000 20_5000 5_60000 40_60000; do
  expect 0 "" "$program" film --load ${at%_*} --speed ${at#*_} $few -o at_$at.json
done
expect 0 "This film ends at .* N as the load rises, and at .* rpm" "$program" film --load 5 --speed 60000 $few --table -
expect 0 "Another film is there at this load and speed" "$program" film --load 5 --speed 5000 $few --html two.html --table -
# A map of speeds goes through the bearing's own film, and its threshold is the end of that.
expect 0 "" "$program" film --load 5 --speed 5000 --mesh 2,4 --speeds 2500:10000:5 --within 10 -o through.json --html through.html
[ "$(sed '1,/Critical mass over speed/d; /<\/svg>/q' through.html | grep -c '<path class="s1" d="M[0-9.]* [0-9.]*L')" = 1 ] \
  || fail "the curve of the critical mass does not break off where the film ends"
grep -q 'the same, another film' two.html || fail "the page lacks the other film"
valid film.schema.json at_5_5000.json
checks - <<'END' || fail "two films under one load"
import json
light, heavy, fast, faster = (json.load(open(f"at_{n}.json")) for n in ("5_5000", "20_5000", "5_60000", "40_60000"))
own, other = light["bearing"], light["other_film"]
assert own["stability"] == "stable" and other["stability"] == "unstable", (own, other)
assert abs(own["attitude_deg"] - other["attitude_deg"]) > 30, (own, other)
assert "other_film" not in fast and "other_film" not in heavy
for one, two in ((light, heavy), (fast, faster)):
    assert abs(one["load_capacity_n"] / two["load_capacity_n"] - 1) < 0.01, (one["load_capacity_n"], two["load_capacity_n"])
assert fast["film_ends_n"] < 0.5 * fast["load_capacity_n"] and faster["film_ends_n"] is None, fast["film_ends_n"]
map_of = json.load(open("through.json"))
for s in map_of["speeds"]:
    assert s["speed_rpm"] != 5000 or abs(s["eccentricity_ratio"] / map_of["bearing"]["eccentricity_ratio"] - 1) < 1e-6, s
assert map_of["eigenvalues"] == light["eigenvalues"], "the studies before the eigenvalues change them"
closer, wider, each = (map_of["tolerance"][k] for k in ("alike_closer_um", "alike_wider_um", "each_um"))
assert min(closer, wider) > 1 and each > 0.2, (closer, wider, each)
assert 7000 < map_of["threshold_rpm"] < 9500 and abs(map_of["threshold_eigen_rpm"] / map_of["threshold_rpm"] - 1) < 4e-4, map_of["threshold_rpm"]
assert fast["lift_off_rpm"] < min(faster["lift_off_rpm"], 0.5 * fast["film_ends_rpm"]), (fast["lift_off_rpm"], faster["lift_off_rpm"])
END

# A film that resonates with the whirl: an eigenvalue of its impedance passes the real axis and back within a fifth of the ratio.
expect 0 "orbit in time: grows" "$program" film --load 4.44 --speed 12335 --clearance 20 --compliance 2 --pads 0 --load-angle 180 --top-foil sagging \
  --top-foil-thickness 0.1 --mesh 2,4 --speeds 10000:36000:4 --orbit 40 -o resonant.json --table -
checks - resonant.json <<'END' || fail "a film that resonates"
import json, sys
r = json.load(open(sys.argv[1]))
for s in [r["bearing"], *r["speeds"]]:
    assert (s["log_decrement"] > 0) == s["stability"].startswith("stable"), s
assert r["bearing"]["stability"] == "unstable" and abs(r["threshold_rpm"] / r["threshold_eigen_rpm"] - 1) < 2e-4, r["threshold_rpm"]
END

# Draws hang on their seed and number alone, and shims of no height are the perfect bearing.
expect 0 "" "$program" film design.json $fast --speeds 30000:90000:2 --shims=-7:7 --draws 12 --jobs 1 -o few.json --draws-out few.csv
[ "$(head -n 13 draws.csv)" = "$(cat few.csv)" ] || fail "draws hang on their number or on the threads"
expect 0 "" "$program" film $fast --speeds 30000:90000:2 --shims 0:0 --draws 1 -o none.json
near "no deviation" "$(value none.json "r['draws']['mass_over_perfect']['median']")" 1 1e-7

# A quantile between a bearing of a finite mass and one that is stable at every mass is none of a mass.
expect 0 "" "$program" film --load 40 --speed 120000 --clearance 80 --compliance 0.67 --mesh 2,4 --bumps 7 --speeds 120000:121000:2 \
  --shims=-50:50 --draws 8 --seed 7 -o mixed.json
checks - <<'END' || fail "quantiles of masses are not right"
import json
q = json.load(open("mixed.json"))["draws"]["mass_over_perfect"]
assert all(v is None or v < 1e6 for v in q.values()), q
END
expect 0 "median 1.59, at 75 % stable at every mass" "$program" film --load 40 --speed 120000 --clearance 80 --compliance 0.67 --mesh 2,4 --bumps 7 \
  --speeds 120000:121000:2 --shims=-50:50 --draws 8 --seed 7 --table -

# Draws that are kept: a run goes on from them, whatever line a kill has cut off; shards joined by cat are the whole; of other settings
# they are refused.
draws="design.json $fast --speeds 30000:90000:2 --shims=-7:7"
expect 0 "" "$program" film $draws --draws 5 --keep kept -o five.json
[ "$(grep -c '^[0-9]' kept)" = 5 ] || fail "five draws are not kept"
truncate -s -20 kept
expect 0 "" "$program" film $draws --draws 12 --keep kept -o twelve.json --draws-out twelve.csv
[ "$(grep -c '^[0-9]' kept)" = 13 ] || fail "kept draws were solved again, or the cut one was not"
cmp -s few.csv twelve.csv || fail "draws that were kept differ from those that are solved at once"
for shard in 1 2; do
  expect 0 "" "$program" film $draws --draws 12 --keep part$shard --shard $shard/2 -o part$shard.json --table part$shard.txt
done
grep -q '6 bearings, shims .*; 6 more are asked for, and not here' part2.txt || fail "a shard does not say that it is a part"
cat part1 part2 >joined
expect 0 "" "$program" film $draws --draws 12 --keep joined --jobs 1 -o joined.json --draws-out joined.csv
cmp -s few.csv joined.csv || fail "joined shards differ from the whole"
[ "$(grep -c '^[0-9]' joined)" = 12 ] || fail "joined draws were solved again"
for other in "--seed 2" "--load 21" "--shims=-7:8" "--mesh 4,4"; do
  expect 65 "draws of another bearing" "$program" film $draws --draws 12 --keep kept $other
done
expect 65 "not a file that" "$program" film $draws --draws 12 --keep design.json
for bad in 0/2 3/2 1.0/3 1/3x ' 1/3' -1/3 +1/3 1/ /3 1; do # like those of lots
  expect 64 "is not I/N with I from 1 to N" "$program" film $draws --draws 12 --keep part1 --shard "$bad"
  expect 64 "is not I/N with I from 1 to N" "$program" lot scans --recipe r.json -o no --shard "$bad"
done
expect 64 "shard needs --keep" "$program" film $draws --draws 12 --shard 1/2

# The job array: here a queue that runs every task at once.
mkdir queue
cat >queue/sbatch <<'END'
#!/bin/bash
for word; do case $word in --array=*) last=${word#--array=1-} ;; --wrap=*) task=${word#--wrap=} ;; esac; done
for ((i = 1; i <= ${last:-1}; i++)); do SLURM_ARRAY_TASK_ID=$i SLURM_CPUS_PER_TASK=1 bash -c "$task" >&2 || exit 1; done
echo 7
END
chmod +x queue/sbatch
PATH=$PWD/queue:$PATH FOILGAUGE=$program "$root/samples/slurm/film.sh" array 2 $draws --draws 12 >said 2>&1 || fail "the job array: $(cat said)"
cmp -s few.csv array/draws.csv && [ -s array/film.html ] || fail "a job array makes other draws"

# Foils as measured: those of the design's clearance are the design's, a closed one lowers the film.
foils() {
  python3 - "$1" <<'END'
import json, sys
bumps = [[{"number": k + 1, "clearance_mm": 0.04} for k in range(9)] for pad in range(3)]
for bump in bumps[2]: bump["clearance_mm"] += float(sys.argv[1])
print(json.dumps({"schema": "foilgauge/measure/1", "foils": [{"bumps": b} for b in bumps]}))
END
}
foils 0 >same.json && foils -0.01 >close.json
expect 0 "as measured" "$program" film $fast --speeds 30000:90000:2 --foils same.json -o as_designed.json --table -
expect 0 "" "$program" film $fast --speeds 30000:90000:2 --foils close.json -o as_measured.json
near "foils as designed" "$(value as_designed.json "r['bearing']['critical_mass_kg'] / r['perfect']['critical_mass_kg']")" 1 1e-7
[ "$(value as_measured.json "r['bearing']['min_film_um'] < r['perfect']['min_film_um'] - 1")" = True ] || fail "a closed pad"
valid film.schema.json as_measured.json

# A lot's foils: the clearance fitted into the sleeve; a failed, a crushed and a short foil stay out, and a part's second scan.
mkdir lot
python3 - <<'END'
foils = open("lot/foils.csv", "w")
bumps = open("lot/bumps.csv", "w")
print("foil,scan,foil_number,verdict", file=foils)
print("foil,scan,foil_number,bump,flags,normalised_stiffness,clearance_mm,clearance_fitted_mm", file=bumps)
for i, (part, verdict, flag, count) in enumerate([("a", "pass", "", 9), ("b", "pass", "", 9), ("c", "no_tolerance", "", 9), ("d", "fail", "", 9),
                                                  ("e", "pass", "crushed", 9), ("f", "pass", "", 8), ("a", "pass", "", 9)]):
    print(f"{part},s{i}.png,1,{verdict}", file=foils)
    for k in range(count):
        print(f"{part},s{i}.png,1,{k + 1},{flag},1,0.9,0.04", file=bumps)
END
expect 0 "6 bearings of 3 different foils each, drawn from 3 \(4 left out\), seed 1" "$program" film $fast --speeds 30000:90000:2 --foils lot --draws 6 \
  -o lot.json --table -
near "a lot as designed" "$(value lot.json "r['draws']['mass_over_perfect']['at_5_pct']")" 1 1e-7
near "a lot as designed" "$(value lot.json "r['draws']['mass_over_perfect']['at_95_pct']")" 1 1e-7
valid film.schema.json lot.json
expect 64 "of one of them" "$program" film $fast --foils lot --shims 0:1
expect 65 "3 foils can be built in, a bearing takes 4" "$program" film $fast --foils lot --pads 4

# The orbit of a rotor just below its critical mass, and one far above.
light=$(value film.json "0.9 * r['perfect']['critical_mass_kg']")
expect 0 "orbit in time: decays" "$program" film $fast --speeds 30000:90000:2 --mass "$light" --orbit 20 --orbit-out orbit.csv --table - --html orbit.html -o orbit.json
[ "$(wc -l <orbit.csv)" = 642 ] && grep -q 'Orbit of the rotor' orbit.html || fail "the orbit"
valid film.schema.json orbit.json
expect 0 "orbit in time: (grows|touches)" "$program" film $fast --speeds 30000:90000:2 --mass 2 --orbit 20 --table -
expect 0 "orbit in time: unknown; too few whirls" "$program" film $fast --speeds 30000:90000:2 --load 5 --clearance 80 --mass 0.5 --orbit 4 --table - -o short.json
[ "$(value short.json 'r["orbit"]["fate"], r["orbit"]["growth_per_turn"]')" = "('unknown', None)" ] || fail "an orbit of few whirls has a fate"
valid film.schema.json short.json
expect 0 "is unstable at all speeds" "$program" film $fast --speeds 30000:90000:2 --load 5 --clearance 80 --mass 0.5 --table -
expect 64 "needs --orbit" "$program" film $fast --orbit-out orbit.csv

# A rotor that is stable at every mass: its orbit decays as its least damped eigenvalue does, and shims are held against no mass of it.
expect 0 "the bearing as designed has none, at any mass" "$program" film --load 20 --speed 20000 --clearance 80 --compliance 0.67 --mesh 2,4 \
  --speeds 20000:20100:2 --orbit 100 --shims=-20:20 --draws 10 -o stable.json --table -
checks - stable.json <<'END' || fail "a rotor that is stable at every mass"
import json, sys
r = json.load(open(sys.argv[1]))
least, orbit, d = r["eigenvalues"][0], r["orbit"], r["draws"]
assert r["bearing"]["stability"] == "stable at every mass" and least["log_decrement"] > 0, r["bearing"]
assert abs(orbit["growth_per_turn"] / (-least["log_decrement"] * least["whirl_ratio"]) - 1) < 0.03, (orbit["growth_per_turn"], least)
assert d["more_stable"]["count"] == 0 < d["less_stable"]["count"] <= d["solved"]["count"] and d["mass_over_perfect"]["median"] is None, d
END

# Sensitivities: the clearance falls by the thickness; the stiffness rises with its cube.
expect 0 "constant arc length" "$program" film $fast --speeds 30000:90000:2 --sensitivity -o worth.json --table - --html worth.html
valid film.schema.json worth.json
near "clearance by thickness" "$(value worth.json "r['sensitivities'][3]['clearance_um_per_pct']")" -1 0.1
near "stiffness by thickness" "$(value worth.json "r['sensitivities'][3]['stiffness_pct_per_pct']")" 3 0.05

# A bore: one of the design's radius changes nothing, an oval one closes the clearance at 0 and 180 degrees.
printf 'angle_deg,radius_mm\n0,20.73\n90,20.73\n180,20.73\n270,20.73\n360,20.73\n' >round.csv
awk 'BEGIN {print "angle_deg,radius_mm"; for (a = 350; a >= 0; a -= 10) printf "%d,%.6f\n", a, 20.73 - 0.004 * cos(2 * a * 3.14159265 / 180)}' >oval.csv
expect 0 "lift-off" "$program" film $fast --speeds 30000:90000:2 --bore round.csv -o round.json --table -
near "a round bore" "$(value round.json "r['bearing']['critical_mass_kg'] / r['perfect']['critical_mass_kg']")" 1 1e-7
expect 0 "load capacity" "$program" film $fast --speeds 30000:90000:2 --bore oval.csv -o oval.json --table -
near "an oval bore" "$(value oval.json "[c['clearance_um'] for c in r['field'] if abs(c['angle_deg']) < 1e-6][0]")" 36 1e-3
valid film.schema.json oval.json
bore() { # bore EXIT WORDS ROW...: a profile of a row per 10 degrees, whose rows are changed by awk's ROW
  awk -v OFS=, "BEGIN {print \"angle_deg,radius_mm\"; for (i = 0; i < 36; i++) {a = 10 * i; r = 20.73; $3; print a, r}}" >bore.csv
  expect "$1" "$2" "$program" film $fast --speeds 30000:90000:2 --bore bore.csv --table -
}
bore 0 "lift-off" ""
bore 65 "row 5: a radius of 41.46 mm is not that of a bore of 20.73 mm; it looks like a diameter" 'if (i == 4) r = 41.46'
bore 65 "row 1: .*; it looks like micrometres" 'r = 20730'
bore 65 "row 1: .*; it looks like inches" 'r = 0.8161'
bore 65 "no radius from 60 to 100 degrees" 'if (i > 6 && i < 10) continue'
bore 65 "no radius from .*are its angles radians" 'a *= 3.14159265 / 180'
bore 65 "80 degrees are there twice, with 20.73 and 20.74 mm" 'if (i == 9) {a = 80; r = 20.74}'
bore 0 "lift-off" 'if (i == 35) {a = 360}'
bore 65 "row 3" 'if (i == 2) r = "NaN"'
bore 65 "row 3" 'if (i == 2) r = "twenty"'
sed -i 's/radius_mm/radius_um/' bore.csv
expect 65 "radius_mm" "$program" film $fast --bore bore.csv

# A lift-off speed: that of a bearing that is wider by 2 um tells 2 um, its own tells none, and its u and the load's go into the shift's: the
# load's u makes of the clearances what a load that is other by its u does. The rotor lifts off in the middle of the one pad.
lifting() { # LOAD CLEARANCE COMPLIANCE NAME [OPTION...]
  expect 0 "${said-}" "$program" film --pads 1 --bumps 21 --load-angle 120 --speed 60000 --mesh 2,4 --speeds 30000:90000:2 --load $1 --clearance $2 --compliance $3 -o $4.json --table - "${@:5}"
}
lifting 20 42 0.638095 wider
lifting 21 40 0.67 heavier
lifted=$(value wider.json "r['lift_off_rpm']")
said="wider, 42" lifting 20 40 0.67 lifted --lift-off $lifted --u-lift-off 5
valid film.schema.json lifted.json
near "shift by the lift-off speed" "$(value lifted.json "r['lift_off_test']['clearance_shift_um']")" 2 0.01
own=$(value lifted.json "r['lift_off_rpm']")
checks - lifted.json wider.json <<'END' || fail "u of the lift-off"
import json, sys
l, w = (json.load(open(n)) for n in sys.argv[1:])
t, slope = l["lift_off_test"], 2 / (w["lift_off_rpm"] - l["lift_off_rpm"])
assert abs(t["u_clearance_shift_um"] / (5 * slope) - 1) < 0.1 and not t["agrees"] and t["u_predicted_rpm"] is None, (t, slope)
END
said="agrees with" lifting 20 40 0.67 lifted --lift-off $(value heavier.json "r['lift_off_rpm']") --u-load 1
[ "$(value lifted.json "abs(abs(r['lift_off_test']['clearance_shift_um']) / r['lift_off_test']['u_by_load_um'] - 1) < 0.15")" = True ] ||
  fail "u by the load: $(value lifted.json "r['lift_off_test']")"
said="agrees with" lifting 20 40 0.67 lifted --lift-off $own --u-lift-off 5
expect 0 "No clearance within" "$program" film $fast --speeds 30000:90000:2 --lift-off 200000 --table -
# A rotor lifts off where it does, from whatever speed it coasts, also at the edge of a pad.
for from in 60000 90000; do
  expect 0 "" "$program" film $fast --speed $from --speeds 30000:90000:2 -o from_$from.json
done
near "lift-off from a higher speed" "$(value from_90000.json "r['lift_off_rpm'] / $(value from_60000.json "r['lift_off_rpm']")")" 1 1e-3

# A tested bearing: a round one whose stiffness is that of the design's bumps is the perfect bearing; an oval one has half of its gap as
# the clearance along both axes.
tested() { # tested FILE GAP_0_MM GAP_90_MM [ROW]
  python3 - "$@" <<'END'
import json, math, sys
path, *gaps = sys.argv[1:4]
bump, length, bumps = 18.23884047, 40, 27
rows = []
for azimuth, gap in zip((30, 120), map(float, gaps)):
    travel = 2 * gap
    reach = math.acos(gap / travel)
    k = bump * length * bumps / (2 * math.pi) * (reach + math.sin(reach) * math.cos(reach))
    rows.append({"azimuth_deg": azimuth, "gap_mm": gap, "u_gap_mm": 0.0004, "u_repeat_gap_mm": 0.0001, "travel_mm": travel, "stiffness_n_mm": k})
rows += [eval(row, {"rows": rows}) for row in sys.argv[4:]]
report = {"schema": "foilgauge/load_test/1", "options": {"azimuth_zero_deg": 30}, "bearings": [{"name": "A"}], "azimuths": rows}
json.dump(report, open(path, "w"))
END
}
tested round.json 0.08 0.08 && tested oval_test.json 0.08 0.076
expect 0 "" "$program" film $fast --speeds 30000:90000:2 --foils round.json -o round.film
near "a tested round bearing" "$(value round.film "r['bearing']['critical_mass_kg'] / r['perfect']['critical_mass_kg']")" 1 1e-6
expect 0 "" "$program" film $fast --speeds 30000:90000:2 --foils oval_test.json -o oval.film
valid film.schema.json oval.film
checks - oval.film <<'END' || fail "a tested oval bearing"
import json, sys
r = json.load(open(sys.argv[1]))
at = {round(c["angle_deg"], 3): c["clearance_um"] for c in r["field"]}
assert abs(at[0] - 40) < 1e-6 and abs(at[173.333] - (40 - 2 * 6.6666667 / 90)) < 1e-3, at
assert abs(at[93.333] - (38 + 2 * 3.3333333 / 90)) < 1e-3, at
assert r["uncertainty"]["u_eccentricity_ratio"] > 0
END
tested bad.json 0.08 0.08 '{**rows[0], "azimuth_deg": 210}'
expect 65 "axis of azimuth 210 is there twice" "$program" film $fast --foils bad.json
tested bad.json 0.08 0.08 '{**rows[0], "azimuth_deg": 60, "gap_mm": None}'
expect 65 "azimuth 60 has no gap" "$program" film $fast --foils bad.json
sed 's/{"name": "A"}/{"name": "A"}, {"name": "B"}/' round.json >bad.json
expect 64 "holds the bore already" "$program" film $fast --foils round.json --bore round.csv
expect 65 "2 bearings, and a film is of one" "$program" film $fast --foils bad.json

# Near lift-off a film may lie before or behind the gap between two pads, and one path meets one of both: no speed of the map between two
# that have a film is without.
no_gaps() {
  expect 0 "" "$program" film $fast --speeds 300:6000:60 --speeds-out gaps.csv -o gaps.json
  checks - gaps.csv <<'END' || fail "gaps of the map"
import csv, sys
outcomes = [row["outcome"] for row in csv.DictReader(open(sys.argv[1]))]
first = next(i for i, o in enumerate(outcomes) if o != "unsolved")
assert 3 < first < 30 and "unsolved" not in outcomes[first:], outcomes
END
}
brief || no_gaps
expect 64 "is of --lift-off" "$program" film $fast --u-lift-off 7
expect 64 "u-load is of --lift-off" "$program" film $fast --u-load 1
expect 64 "lift-off RPM: '0' is not a number" "$program" film $fast --lift-off 0
[ "$(value oval.json "20 < r['load_capacity_n'] and r['lift_off_rpm'] < 60000")" = True ] || fail "limits of the load and the speed"

# A load beyond the film, and a touching one.
expect 65 "no film at" "$program" film --load 5000 --speed 3000 --clearance 40 --compliance 0 --mesh 2,4
expect 0 "touching" "$program" film $fast --speeds 30000:90000:2 --touching 100 --table -

# The u of foils goes into the film's: of a thickness that all bumps share as two films beside it differ, and none without a u.
uniform() { # uniform CLEARANCE_MM U_MM U_THICKNESS_MM
  python3 - "$@" <<'END'
import json, sys
c, u, t = map(float, sys.argv[1:])
bumps = [{"number": k + 1, "clearance_mm": c, "u_clearance_mm": u} for k in range(9)]
print(json.dumps({"schema": "foilgauge/measure/1", "foils": [{"u_thickness_mm": t, "bumps": bumps}] * 3}))
END
}
uniform 0.04 0.0004 0.0004 >shared.json && uniform 0.0404 0 0 >above.json && uniform 0.0396 0 0 >below.json && uniform 0.04 0.0004 0 >own.json
for foils in shared above below own; do
  expect 0 "" "$program" film $fast --speeds 30000:90000:2 --foils $foils.json -o $foils.film
  valid film.schema.json $foils.film
done
checks - shared.film above.film below.film own.film <<'END' || fail "u of the film"
import json, sys
shared, above, below, own = (json.load(open(n)) for n in sys.argv[1:])
assert "uncertainty" not in above
for name, tolerance in (("min_film_um", 0.25), ("eccentricity_ratio", 0.25), ("critical_mass_kg", 0.35)):
    slope = abs(above["bearing"][name] - below["bearing"][name]) / 2
    assert abs(shared["uncertainty"]["u_" + name] / slope - 1) < tolerance, (name, shared["uncertainty"], slope)
assert 0 < own["uncertainty"]["u_eccentricity_ratio"] != shared["uncertainty"]["u_eccentricity_ratio"]
low, high = shared["uncertainty"]["critical_mass_95_kg"]
assert low < shared["bearing"]["critical_mass_kg"] < high
END

# A tolerance on the clearance by the threshold speed: all bumps alike keep it within, and three tenths more do not.
tolerances() {
  rotor="--load 20 --speed 30000 --clearance 32 --compliance 0.67 --mass 0.3 --speeds 8000:40000:12 --mesh 2,4"
  expect 0 "threshold speed \([0-9]* rpm as designed\) stays" "$program" film $rotor --within 10 --shims=-1:1 --draws 10 -o within.json --table -
  valid film.schema.json within.json
  for side in closer wider; do
    for share in 1 1.3; do
      sign=$([ $side = closer ] && echo - || echo +)
      uniform "$(value within.json "(32 $sign $share * r['tolerance']['alike_${side}_um']) / 1000")" 0 0 >moved.json
      expect 0 "" "$program" film $rotor --foils moved.json -o moved.film
      kept=$(value moved.film "abs(r['threshold_rpm'] / $(value within.json "r['tolerance']['threshold_rpm']") - 1) <= 0.1")
      [ $kept = $([ $share = 1 ] && echo True || echo False) ] || fail "the threshold of bumps that are $side by $share of the tolerance: $kept"
    done
  done
  checks - within.json <<'END' || fail "tolerances"
import json, sys
r = json.load(open(sys.argv[1]))
t, d = r["tolerance"], r["draws"]
assert 0 < t["each_um"] <= t["each_not_lower_um"] < t["alike_closer_um"], t
assert d["within"]["count"] <= d["not_lower"]["count"] <= 10, d
END
  expect 0 "No tolerance on the clearance is told" "$program" film $rotor --speeds 30000:40000:2 --within 10 --table -
}
brief || tolerances

# Bad input.
while IFS='|' read -r code words options; do
  expect "$code" "$words" "$program" film $options
done <<'END'
64|needs --load N and --speed|--load 5
64|not LOW:HIGH|--load 5 --speed 60000 --shims 7
64|need --shims|--load 5 --speed 60000 --draws 7
64|even number|--load 5 --speed 60000 --mesh 3,4
64|neither stiff nor|--load 5 --speed 60000 --top-foil soft
64|no model of|--load 5 --speed 60000 --clearance 80 --model own
64|do not fit|--load 5 --speed 60000 --clearance 80 --pitch 20
64|states none|--load 5 --speed 60000 --clearance 80 --top-foil sagging
64|ambient KPA: '101325'|--load 5 --speed 60000 --ambient 101325
64|ambient KPA: '1.013'|--load 5 --speed 60000 --ambient 1.013
64|clearance UM: '0.08'|--load 5 --speed 60000 --clearance 0.08
64|viscosity UPAS: '1.85e-5'|--load 5 --speed 60000 --viscosity 1.85e-5
64|length MM: '0.04'|--load 5 --speed 60000 --length 0.04
64|speed RPM: '-60000'|--load 5 --speed -60000
64|load N: 'nan'|--load nan --speed 60000
64|has at most 96|--load 5 --speed 60000 --clearance 80 --pads 20
END
expect 65 "not a report of .foilgauge measure" "$program" film $fast --foils film.json
expect 65 "2 foils for a bearing of 3 pads" "$program" film $fast --foils <(sed 's/{"bumps": .*\({"bumps"\)/{"bumps": [] }, \1/' same.json)
expect 65 "needs a design with bumps" "$program" film "$root/samples/top_foil_design.json" $fast
exit $failed
