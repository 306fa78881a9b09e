#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: tests of bearings with known clearance, stiffness and friction come back, in whatever way the
# table is written; gaps of a table; limits and exit codes; a bearing against the lot's foils, and the table for
# the loop, which finds the planted effect.
. tests/support/cli.sh
listened="stdout stderr"

# make NAME GAP_UM AZIMUTHS [CYCLES [SIDE]]: rows of a bearing. Gap g, then K = 1000 N/mm; friction 1.032 N + 0.03 |F|,
# which turns round over 4 um; noise of 0.05 N (noise_n). The loading strokes pass 20 N at K d 1.03 + 1.032 = 20: 18.415 um behind
# the gap's edge, so the clearance is g + 36.83 um.
make() {
  awk -v name="$1" -v gap="$2" -v list="$3" -v cycles="${4:-3}" -v side="${5:-both}" -v shift="${shift_um:-0}" -v noise="${noise_n:-0.05}" \
    -v seed="${seed:-7}" 'BEGIN {
    srand(seed); pi = atan2(0, -1); n = split(list, azimuths, " ")
    for (k = 1; k <= n; k++) for (i = 0; i < 300 * cycles; i++) {
      phase = 2 * pi * i / 300; x = 0.18 * sin(phase); sense = cos(phase) >= 0 ? 1 : -1
      g = gap + shift * cos(azimuths[k] * pi / 180)
      d = (x < 0 ? -x : x) - g / 2000; f = d > 0 ? (x < 0 ? -1000 : 1000) * d : 0
      way = i < 75 ? x + 0.5 : 0.18 + sense * x
      f += sense * (1.032 + 0.03 * (f < 0 ? -f : f)) * (1 - 2 * exp(-way / 0.004))
      f += noise * sqrt(-2 * log(1 - rand())) * cos(2 * pi * rand())
      if (side == "push" && x < 0) continue
      printf "%s,%g,%d,%.3f,%.6f,%.4f\n", name, azimuths[k], 1 + i / 300, i / 50, x, f
    } }'
}
heading="bearing,azimuth_deg,cycle,time_s,displacement_mm,force_N"
(echo $heading && make A 143.17 "0 60 120" && make B 103.17 "0") >test.csv
run() { expect "$1" "$2" "$program" stiffness --threshold 20 "${@:3}"; }

run 0 "" test.csv -o r.json --html r.html --csv r.csv --text r.txt --table-out t.csv
python3 - r.json <<'END' || fail "the report is not the truth"
import json, sys
r = json.load(open(sys.argv[1]))
bad = []
for a in r["azimuths"]:
    truth = {"A": 0.180, "B": 0.140}[a["bearing"]]
    if not (abs(a["clearance_mm"] - truth) < 0.0005 and a["u_repeat_clearance_mm"] < 0.0005):
        bad.append((a["bearing"], a["azimuth_deg"], a["clearance_mm"], a["u_repeat_clearance_mm"]))
    # The displacement's 1.3 % and the load cell's 1 % of 20 N over 1030 N/mm at both ends.
    u = (a["u_repeat_clearance_mm"]**2 + (0.013 * truth)**2 + (2 * 0.01 * 20 / 1030)**2)**0.5
    if not abs(a["u_clearance_mm"] - u) < 0.03 * u:
        bad.append(("u", a["u_clearance_mm"], u))
    if not abs(a["stiffness_n_mm"] - 1030) < 4 * a["u_repeat_stiffness_n_mm"] < 206:
        bad.append(("K", a["stiffness_n_mm"], a["u_repeat_stiffness_n_mm"]))
    scale = (a["u_stiffness_n_mm"]**2 - a["u_repeat_stiffness_n_mm"]**2)**0.5 / a["stiffness_n_mm"]
    if not abs(scale - (0.013**2 + 0.01**2)**0.5) < 1e-6:
        bad.append(("1.64 %", scale))
    # The unloading strokes pass 20 N at K d 0.97 - 1.032: 21.682 um behind the edge.
    if not abs(a["clearance_unloading_mm"] - truth - 2 * (0.021682 - 0.018415)) < 0.0006:
        bad.append(a["clearance_unloading_mm"])
    f = a["friction"]
    if not (abs(f["intercept_n"] - 1.032) < 0.04 and abs(f["slope"] - 0.03) < 0.0012):
        bad.append(f)
    # Slopes of both sides over the displacement, steep outside of the gap and next to nothing in it.
    for side in "course_push", "course_pull":
        course = a[side]
        if not (len(course) > 40 and course[-1][2] > 900 > 100 > course[0][2]):
            bad.append((side, len(course)))
    if not abs(a["force_zero_n"]) < 0.05:
        bad.append(("zero", a["force_zero_n"]))
    loss = a["loop_area_n_mm"] / (3.14159265 * a["stiffness_n_mm"] * 0.18**2)
    if not abs(loss / a["loss_factor"] - 1) < 0.02:
        bad.append(("loss", loss))
for b in r["bearings"]:
    # The hysteresis between the strokes is no preload: that takes a break-away test.
    if not abs(b["radial_hysteresis_n"] - 1.032) < 2 * b["u_radial_hysteresis_n"] < 0.2:
        bad.append(("hysteresis", b["radial_hysteresis_n"], b["u_radial_hysteresis_n"]))
    if b["preload_n"] is not None or b["preload_kpa"] is not None:
        bad.append(("preload", b["preload_kpa"]))
print(*bad, sep="\n")
sys.exit(bool(bad))
END
# Defaults are the thesis's: load cell 1 %, optical probe 1.3 %; the help says the same.
[ "$(value r.json '[r["options"][k] for k in ("u_force_pct", "u_displacement_pct")]')" = "[1, 1.3]" ] || fail "instruments"
"$program" stiffness --help | tr -s ' \n' ' ' >help.txt
grep -q "load cell.s scale (default: 1 %" help.txt && grep -q "displacement probe.s scale (default: 1.3 %" help.txt || fail "instruments in the help"
# The thesis's plan: 0, 120 and 240 degrees are three axes; clearances of 200, 170, 170 um are smallest along 90 degrees.
(echo $heading && make A 163.17 0 && make A 133.17 "120 240") >plan.csv
run 0 "smallest along the axis .* and .* degrees" plan.csv --text -
run 0 "" plan.csv -o plan.json --html plan.html
[ "$(value plan.json '[(abs(b["smallest_at_deg"] - 90) < 2 * b["u_smallest_at_deg"] < 3, [h["order"] for h in b["harmonics"]], b["smallest_not_known"])
  for b in r["bearings"]]')" = "[(True, [2], None)]" ] || fail "the axis of the smallest clearance"
(echo $heading && make A 163.17 "0 180" && make A 133.17 90) >plan.csv
run 0 "no axis of the smallest clearance: azimuths lie on fewer than three axes" plan.csv --text -
# A digital indicator shows whole steps: the report names them, and the values stay within U.
awk -F, -v OFS=, 'NR > 1 { $5 = sprintf("%.3f", $5) } { print }' test.csv >steps.csv
run 0 "" steps.csv -o steps.json --text steps.txt --html steps.html
checks - steps.json r.json <<'END' || fail "a displacement in steps"
import json, sys
steps, fine = (json.load(open(path))["azimuths"] for path in sys.argv[1:])
for a, b in zip(steps, fine):
    assert b["displacement_step_mm"] is None and b["displacement_noise_mm"] < 0.0001, b["displacement_noise_mm"]
    assert abs(b["force_noise_n"] - 0.05) < 0.02, b["force_noise_n"]
    assert abs(a["displacement_step_mm"] - 0.001) < 1e-9 and a["displacement_noise_mm"] > 0.000288, a["displacement_noise_mm"]
    for name in "clearance_mm", "stiffness_n_mm", "loss_factor":
        off = abs(a[name] - b[name])
        assert off < 2.5 * a["u_repeat_" + name], (name, a[name], b[name], a["u_repeat_" + name])
END
grep -q "in steps of 1 um" steps.txt && grep -q "in steps of 1 µm" steps.html || fail "the step is not named"

[ "$(wc -l <r.csv)" = 5 ] && [ "$(wc -l <t.csv)" = 5 ] || fail "rows of the tables"
head -1 t.csv | 
  grep -qx "bearing,azimuth_cosine,azimuth_sine,azimuth_cosine_2,azimuth_sine_2,clearance_um" || fail "the table's columns"
for words in "Bearing A" "<svg" "180[.]" "N/mm" "Radial hysteresis" "together 1.64 %" "<h1>Load-displacement tests" \
  "<dt>Not judged</dt><dd>clearance_mm, stiffness_n_mm" "<dt>Program</dt>"; do
  grep -q "$words" r.html || fail "the page has no '$words'"
done
[ "$(grep -c 'class="ci"' r.html)" = 8 ] || fail "the page has not every course"
[ "$(grep -c 'class="land"' r.html)" = 4 ] || fail "the page has not every loop"

# A sanitized run says nothing more of what only reads or writes otherwise.
whole() { [ -z "${FOILGAUGE_TEST_BRIEF:-}" ]; }
clearances='[round(a["clearance_mm"], 5) for a in r["azimuths"]]'
found=$(value r.json "$clearances")
first() { grep '^A,0,' test.csv | cut -d, -f4- | (echo "time_s,displacement_mm,force_N" && cat); }
first >a0.csv
alone() { run "$1" "$2" --azimuth 0 "${@:3}" --text -; }

# Written otherwise it is the same test: a European table, other units and names, several files.
if whole; then
  (echo "bearing;Azimuth [deg];Force [kN];displacement_um;note" &&
    awk -F, 'NR > 1 { printf "%s;%s;%.7f;%.3f;x\n", $1, $2, $6 / 1000, 1000 * $5 }' test.csv | tr . ,) >europe.csv
  run 0 "" europe.csv -o other.json
  [ "$(value other.json "$clearances")" = "$found" ] || fail "a European table: $(value other.json "$clearances")"
  [ "$(value other.json 'r["inputs"][0]["columns_not_read"]')" = note ] || fail "what is not read"
  run 0 "" --bearing A --azimuth 0 a0.csv -o other.json
  [ "$(value other.json "$clearances")" = "${found%%,*}]" ] || fail "one file of one azimuth"
fi
awk -F, -v OFS=, 'NR > 1 { $3 = -$3 } { print }' a0.csv >turned.csv
run 0 "the force runs against the displacement" --azimuth 0 turned.csv --text -

# Missing results have their reason; the others are still there.
(echo $heading && make A 143.17 "0" && make A 143.17 "60" 3 push) >half.csv
run 2 "" half.csv -o half.json
run 2 "pushed or pulled only" half.csv --text -
[ "$(value half.json '[a["clearance_mm"] is None for a in r["azimuths"]]')" = "[False, True]" ] || fail "half of a test"
expect 2 "the foil is not touched, there is no clearance" "$program" stiffness --threshold 500 --azimuth 0 a0.csv --text -
head -9 a0.csv >few.csv
run 2 "too few samples" --azimuth 0 few.csv --text -
(echo $heading && make A 143.17 "0" 1) >one.csv
run 0 "one cycle: nothing says how cycles differ" one.csv --text -

# A load cell's zero is taken out; one beyond half of the threshold, friction beyond it, rows out of time name none.
changed() { awk -F, -v OFS=, "NR > 1 { $1 } { print }" a0.csv >changed.csv; }
changed '$3 += 6'
run 0 "" --azimuth 0 changed.csv -o zero.json
[ "$(value zero.json '[abs(a["force_zero_n"] - 6) < 0.05 and abs(a["clearance_mm"] - 0.18) < 0.0005 for a in r["azimuths"]]')" = "[True]" ] ||
  fail "beside a zero"
changed '$3 += 24'
alone 2 "the load cell's zero is off by more than half of the threshold" changed.csv
changed '$3 += 21 * ((NR + 73) % 300 < 150 ? 1 : -1)'
alone 2 "there is no clearance" changed.csv
(head -1 a0.csv && sed 1d a0.csv | tac) | cut -d, -f2- >changed.csv
alone 2 "the loops run the wrong way round" changed.csv
run 2 "" --azimuth 0 changed.csv -o back.json
[ "$(value back.json '[r["azimuths"][0][k] for k in ("clearance_mm", "stiffness_n_mm", "loss_factor")]')" = "[None, None, None]" ] ||
  fail "loops that give energy have values"
# No friction: the noise alone decides which way round the loops run, and that is no reason.
awk 'BEGIN { srand(3); print "displacement_mm,force_N"; for (i = 0; i < 900; i++) { x = 0.18 * sin(i / 47.746)
  d = (x < 0 ? -x : x) - 0.07; print x "," (d > 0 ? (x < 0 ? -1000 : 1000) * d : 0) + 0.2 * (rand() - 0.5) } }' >even.csv
run 0 "" --azimuth 0 even.csv -o even.json
grep -q energy_gained even.json && fail "energy gained by noise alone"
run 0 "are the units what they say" --azimuth 0 a0.csv --diameter 3 --text -
cp a0.csv again.csv
run 65 "again.csv: the same bytes as a0.csv" --azimuth 0 a0.csv again.csv
# A bearing that is alike from every side has no direction of its own, and no u is below zero.
changed '$3 += 0'
for deg in 30 60 90 120; do changed '$2 += 0' && sed "s/^/$deg,/;1s/$deg,/azimuth_deg,/" changed.csv; done |
  awk 'NR == 1 || !/azimuth/' >alike.csv
run 0 "" alike.csv -o alike.json
[ "$(value alike.json 'r["bearings"][0]["smallest_at_deg"]')" = None ] || fail "a direction of a round bearing"

# Bad data.
bad() { # WORDS, text on standard input
  cat >bad.csv
  expect 65 "$1" "$program" stiffness bad.csv
}
printf '' | bad "bad.csv: empty"
echo $heading | bad "a header, but no rows"
sed '9s/,[^,]*$/,1e30/' test.csv | bad "line 9.*a force of 1e.30 N"
sed '9s/,[^,]*,\([^,]*\)$/,-1e200,\1/' test.csv | bad "line 9.*a displacement of -1e.200 mm"
sed 's/azimuth_deg/place/' test.csv | bad "no column of the azimuth; it must be called azimuth_deg or azimuth_rad, or say"
sed 's/force_N/force_kg/' test.csv | bad "'kg' is no unit of force but of mass: multiply kilograms by 9.80665"
sed 's/force_N/force/' test.csv | bad "'force' has no unit; call it force_N"
if whole; then
  sed 's/displacement_mm/displacement_inch/' test.csv | bad "'inch' is no unit of displacement"
  sed 's/displacement_mm/force_kN/' test.csv | bad "two columns of force"
  sed '7s/,[^,]*$/,NaN/' test.csv | bad "row 6"
  sed '7s/,[^,]*$/,lots/' test.csv | bad "lots"
  sed '7s/^A//' test.csv | bad "line 7.*'bearing' is empty"
  sed '7p' test.csv | bad "line 8.*the time 0.1 is there twice"
  awk 'NR == 7 { kept = $0; next } { print } NR == 8 { print kept }' test.csv | bad "line 8.*follows a later"
  awk -F, -v OFS=, 'NR > 1 { $3 = 9 - $3 } { print }' test.csv | bad "cycle 7 follows cycle 8"
  awk -F, -v OFS=, 'NR > 1 { $2 = NR } { print }' test.csv | bad "more than 1000 different azimuths"
fi
run 74 "nothere.csv" nothere.csv
expect 64 "no TEST" "$program" stiffness
expect 64 "is none of clearance_mm" "$program" stiffness --limit radius=1: test.csv
expect 64 "has no limits" "$program" stiffness --limit clearance_mm=2:1 test.csv
expect 64 "the test" "$program" stiffness test.csv -o test.csv
[ ! -e /dev/full ] || run 74 "" test.csv -o /dev/full

# Limits: inside, outside, within U of one.
run 0 "pass: " test.csv --limit clearance_mm=0.10:0.25 --limit radial_hysteresis_n=:2 --text -
run 1 "fail: .*beyond a limit" test.csv --limit clearance_mm=0.16: --text -
run 3 "with a limit within U" test.csv --limit clearance_mm=:0.1802 --text -

# Against a lot: a rotor meets the foils' places, which is its gap and not its travel at 20 N; the difference grows with the azimuth's cosine, and the loop says so.
mkdir -p lot
python3 - >lot/lot.json <<'END'
import json
angle = [10 * i for i in range(36)]
print(json.dumps({"schema": "foilgauge/lot/1", "bearings": [
    {"name": name, "number": 1, "pads": ["a", "b", "c"], "angle_deg": angle, "u_clearance_mm": [0.001] * 36,
     "clearance_mm": [0.07158 + 0.00002 * (i * 7 % 5) for i in range(36)]} for name in "AB"]}))
END
shift_um=6 noise_n=1 step=20
whole || step=120
(echo $heading && for name in A B; do seed=$((${seed:-7} + 1)) && make $name 143.17 "$(seq -s' ' 0 $step 340)" 2; done) >planted.csv
run 0 "" planted.csv --lot lot -o lot.json --table-out lot.csv
[ "$(value lot.json '[(abs(a["predicted_clearance_mm"] - 0.14317) < 0.0005, abs(a["clearance_difference_mm"] - 0.006) < 2 * a["u_clearance_difference_mm"] < 0.02)
  for a in r["azimuths"][:1]]')" = "[(True, True)]" ] || fail "predicted, difference"
if whole; then
  expect 0 "" "$program" loop --table lot.csv --response difference_um --model 1 -o loop.json
  python3 - loop.json <<'END' || fail "the loop does not find the azimuth's cosine"
import json, sys
r = json.load(open(sys.argv[1]))
words = json.dumps(r["claims"])
sys.exit(not (r["verdict"] == "explained" and "azimuth_cosine" in words))
END
fi
judged() { run "$1" "$2" --bearing A --azimuth 0 a0.csv --lot "${3:-changed}" "${@:4}"; }
cp -r lot kept && judged 64 "the lot" lot -o lot/lot.json && cmp -s lot/lot.json kept/lot.json || fail "the lot was overwritten"
judged 0 "" lot -o small.json
! whole || valid load_test.schema.json r.json half.json small.json
mkdir -p changed
lot() { sed "$1" lot/lot.json >changed/lot.json; }
lot 's/"A"/"X"/;s/"B"/"Y"/' && judged 65 "none of its bearings is called as one of the tests"
lot 's/"pads": \["a", /&"d", "e", /' && judged 65 "changed/lot.json: the bearing 'A' has 36 places on 5 pads"
lot 's/\("angle_deg": \[\)0/\1null/' && judged 65 "changed/lot.json: place 1 of the bearing 'A' has no angle_deg"
lot 's/\("clearance_mm": \[\)0/\1-0/' && judged 65 "place 1 of the bearing 'A' has "
echo '{"schema": 1}' >changed/lot.json
judged 65 "not the report of a lot"

exit $failed
