#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness --break-away`: friction coefficient and preload of break-away tests with known truth, how often U
# holds it, what a table can lack; and that no preload is made of the friction between the strokes of a load test.
. tests/support/cli.sh
listened="stdout stderr"
run() { expect "$1" "$2" "$program" stiffness "${@:3}"; }

# Pulls with known truth: torque = (mu (W + P) + rig) 20 mm, on a bore of 40 mm. 300 bearings, each with gains of the
# load cell and of the weights of its own (1 %, standard) and a scatter that does not, or does, grow with the load.
python3 - <<'END'
import random
def pulls(r, mu, preload, rig, weights, repeats, sd, share, gains=0.01, curve=0, hung=0):
    force, weight = 1 + r.gauss(0, gains), 1 + r.gauss(0, gains)
    for w in weights:
        alike = r.gauss(0, hung) if hung else 0  # of all pulls of a weight that is hung once
        for repeat in range(repeats):
            slip = mu * (w + preload) * (1 + r.gauss(0, share)) + rig + curve * w * w + r.gauss(0, sd) + alike
            yield w / weight, repeat + 1, slip * force * 20
weights = [20, 60, 100, 150, 200, 240, 280, 319.5]
def write(name, bearings):
    with open(name, "w") as out:
        out.write("bearing,dead_weight_N,repeat,torque_N_mm\n")
        for bearing, rows in bearings:
            out.writelines(f"{bearing},{w:.5f},{k},{t:.4f}\n" for w, k, t in rows)
r = random.Random(29)
write("even.csv", [(i, pulls(r, 0.03, 34.4, 0.5, weights, 3, 0.05, 0)) for i in range(300)])
write("grows.csv", [(i, pulls(r, 0.03, 34.4, 0.5, weights, 5, 0.005, 0.03)) for i in range(300)])
write("no_preload.csv", [(i, pulls(r, 0.03, 0, 0.5, weights, 3, 0.05, 0)) for i in range(300)])
write("few.csv", [(i, pulls(r, 0.03, 34.4, 0.5, weights[::3], 2, 0.02, 0)) for i in range(300)])
write("hung.csv", [(i, pulls(r, 0.03, 34.4, 0.5, weights, 3, 0.025, 0, hung=0.1)) for i in range(300)])
# 1.032 N / 0.03 over pi 40 mm 40 mm: the thesis prints 6.85 kPa.
write("thesis.csv", [("T", pulls(r, 0.03, 34.4, 0, weights, 3, 0, 0, 0))])
write("curved.csv", [("C", pulls(r, 0.03, 34.4, 0, weights, 3, 0.02, 0, 0, 2e-5))])
write("flat.csv", [("F", pulls(r, 0, 0, 1, weights, 3, 0.05, 0, 0))])
write("one.csv", [("O", pulls(r, 0.03, 34.4, 0, [100], 5, 0.02, 0, 0))])
write("two.csv", [("W", pulls(r, 0.03, 34.4, 0, [100, 300], 2, 0.02, 0, 0))])
END

for name in even grows no_preload few hung; do
  "$program" stiffness --break-away $name.csv --rig-torque 10 -o $name.json
  checks - $name.json <<'END' || fail "$name: U does not hold the truth as often as it says"
import json, math, sys
name = sys.argv[1]
preload = 0 if "no_preload" in name else 34.4
truth = {"friction_coefficient": 0.03, "friction_no_weight_n": 0.03 * preload}
tests, inside, known = json.load(open(name))["bearings"], {}, 0
for b in tests:
    if b["preload_n"] is None:
        continue
    known += 1
    a = b["break_away"]
    assert abs(b["preload_kpa"] - 1000 * b["preload_n"] / (math.pi * 1600)) < 1e-6
    for key, true in truth.items():
        inside[key] = inside.get(key, 0) + (abs(a[key] - true) <= 2 * a["u_" + key])
    inside["preload_n"] = inside.get("preload_n", 0) + (abs(b["preload_n"] - preload) <= 2 * b["u_preload_n"])
shares = {key: round(count / known, 3) for key, count in inside.items()}
print(name, known, shares)
# 300 tests: 95 % is right, 91 % is three standard errors below.
alike = sum("weights_differ" in b["break_away"]["flags"] for b in tests) / len(tests)
assert alike > 0.98 if name == "hung.json" else alike < 0.2, alike
sys.exit(not (known >= 0.95 * len(tests) and all(0.91 <= share for share in shares.values())))
END
done

run 0 "preload 34.40 N.*: 6.844 kPa" --break-away thesis.csv --rig-torque 0 --text -
run 0 "the rig's own friction counts as preload: give it by --rig-torque" --break-away thesis.csv --html thesis.html --text -
for words in "Break-away test" "6[.]84 kPa" "Friction coefficient" "0[.]0300" "counts as preload"; do
  grep -q "$words" thesis.html || fail "the page has no '$words'"
done
run 0 "pass: 1 bearing: preload 6.84 kPa" --break-away thesis.csv --limit preload_kpa=5:8 --limit friction_coefficient=:0.05 --text -
run 1 "fail: " --break-away thesis.csv --limit preload_kpa=:5 --text -
# Results that cannot be known are withheld, with the reason.
run 2 "no straight line: neither coefficient nor preload" --break-away curved.csv --text -
run 2 "known no better than to a third" --break-away flat.csv --text -
run 2 "too few pulls" --break-away one.csv --text -
run 0 "too few weights or pulls to say whether the line is straight" --break-away two.csv --text -
run 2 "less friction than the rig's by more than U" --break-away thesis.csv --rig-torque 40 --text -
run 0 "the preload lies within U of none" --break-away thesis.csv --rig-torque 20.64 --u-rig-torque 2 --text -
run 2 "" --break-away curved.csv -o curved.json
[ "$(value curved.json '[r["bearings"][0]["preload_n"], r["bearings"][0]["break_away"]["friction_coefficient"]]')" = "[None, None]" ] ||
  fail "a curve has values"

# Written otherwise it is the same test.
preloads='round(r["bearings"][0]["preload_n"], 3)'
run 0 "" --break-away thesis.csv -o r.json
same() { # NAME [OPTION...], table on standard input
  cat >other.csv
  run 0 "" --bearing T --break-away other.csv "${@:2}" -o other.json
  [ "$(value other.json "$preloads")" = "$(value r.json "$preloads")" ] || fail "$1: $(value other.json "$preloads")"
}
awk -F, -v OFS=';' 'NR == 1 { print "Dead weight [kN]", "Torque [N m]" } NR > 1 { printf "%.8f;%.9f\n", $2 / 1000, $4 / 1000 }' thesis.csv |
  tr . , | same "a European table"
awk -F, 'NR == 1 { print "dead_weight_N,force_N" } NR > 1 { printf "%s,%.8f\n", $2, $4 / 20 }' thesis.csv | same "a force"
awk -F, 'NR == 1 { print "dead_weight_N,force_N,note" } NR > 1 { printf "%s,%.8f,x\n", $2, $4 / 100 }' thesis.csv |
  same "a force on a lever" --lever 100
[ "$(value other.json 'r["inputs"][0]["columns_not_read"]')" = note ] || fail "what is not read"

bad() { # WORDS, text on standard input
  cat >bad.csv
  expect 65 "$1" "$program" stiffness --break-away bad.csv
}
sed 's/dead_weight_N/weight/' thesis.csv | bad "no column of the dead weight; it must be called dead_weight_N"
sed 's/dead_weight_N/dead_weight_kg/' thesis.csv | bad "no unit of dead weight but of mass: multiply kilograms by 9.80665"
sed 's/torque_N_mm/torque/' thesis.csv | bad "'torque' has no unit; call it torque_N_mm"
sed 's/torque_N_mm/turn/' thesis.csv | bad "no column of the torque or of the force at break-away"
sed 's/repeat/force_N/' thesis.csv | bad "one follows from the other, leave one"
sed '4s/,[^,]*$/,-3/' thesis.csv | bad "line 4.*a torque of -3; give its size, without a sign"
sed '4s/,[^,]*$/,/' thesis.csv | bad "row 3"
sed '4s/,[^,]*$/,much/' thesis.csv | bad "much"
sed '4s/^T,[^,]*/T,1e30/' thesis.csv | bad "a dead weight of 1e.30; none is beyond"
echo dead_weight_N,torque_N_mm | bad "a header, but no rows"
cp thesis.csv again.csv
run 65 "again.csv: the same bytes as thesis.csv" --break-away thesis.csv --break-away again.csv
run 74 "nothere.csv" --break-away nothere.csv
expect 64 "no TEST" "$program" stiffness
expect 64 "there is none" "$program" stiffness r.csv --rig-torque 3
expect 64 "without --rig-torque" "$program" stiffness --break-away thesis.csv --u-rig-torque 3
expect 64 "the break-away test" "$program" stiffness --break-away thesis.csv -o thesis.csv

# A bearing with 160 um of gap in a rig with 1 N of friction has no preload: what lies between the strokes is said in N,
# and what a break-away test shows beside a gap is other friction.
awk 'BEGIN { srand(5); print "azimuth_deg,displacement_mm,force_N"
  for (i = 0; i < 1800; i++) { x = 0.12 * sin(i / 600 * 6.2831853); sense = cos(i / 600 * 6.2831853) >= 0 ? 1 : -1
    d = (x < 0 ? -x : x) - 0.08; f = d > 0 ? (x < 0 ? -1000 : 1000) * d : 0
    f += sense * (1 + 0.03 * (f < 0 ? -f : f)) + 0.05 * sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand())
    print 0 "," x "," f } }' >gap.csv
run 0 "" gap.csv -o gap.json --text gap.txt --html gap.html
[ "$(value gap.json '[r["bearings"][0][k] for k in ("preload_n", "preload_kpa", "break_away")]')" = "[None, None, None]" ] ||
  fail "a preload without a break-away test"
[ "$(value gap.json 'abs(r["bearings"][0]["radial_hysteresis_n"] - 1) <= 2 * r["bearings"][0]["u_radial_hysteresis_n"] < 0.2')" = True ] ||
  fail "radial hysteresis: $(value gap.json '[r["bearings"][0][k] for k in ("radial_hysteresis_n", "u_radial_hysteresis_n")]')"
grep -q "preload" gap.txt && fail "the table speaks of a preload"
grep -q "that takes a break-away test" gap.html || fail "the page does not say where a preload comes from"
run 2 "" gap.csv --limit preload_kpa=1:9 --text -
sed 's/^bearing,//;s/^T,//' thesis.csv >unnamed.csv
run 0 "the load test has a gap, where nothing presses the rotor" gap.csv --break-away unnamed.csv --text -
run 3 "cannot tell" gap.csv --break-away unnamed.csv --limit preload_kpa=:5 --text -
run 0 "" gap.csv --break-away unnamed.csv -o both.json
[ "$(value both.json '[(b["name"], b["azimuths"], b["break_away"]["pulls"]) for b in r["bearings"]]')" = "[('gap', 1, 24)]" ] ||
  fail "a break-away test without a name is that of the only bearing"
valid load_test.schema.json r.json curved.json gap.json both.json
exit $failed
