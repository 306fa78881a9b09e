#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Cycles over a column in `foilgauge loop --table`: orders of one base are one effect, with amplitude and phase; a base is
# known of angles, declared, or sought; places are even, uneven, or further apart than the period.
. tests/support/cli.sh
skip_when_slow # test_loop_table.sh sees the same search

cat >made.py <<'P'
import math, random
rng = random.Random()
def write(name, column, places, orders, base, slope=0.01, noise=0.2):
    rng.seed(name)
    rng.shuffle(places)
    with open(name + ".csv", "w") as out:
        out.write(f"{column},way,room_C,error_um\n")
        for x in places:
            way = rng.choice(("up", "down"))
            y = 5 + slope * x + 0.4 * (way == "up") + rng.gauss(0, noise)
            y += sum(a * math.cos(2 * math.pi * k * x / base - math.radians(p)) for k, a, p in orders)
            out.write(f"{x:.4f},{way},{rng.gauss(20, 1):.2f},{y:.4f}\n")
write("turn", "angle_deg", [5.0 * i for i in range(72)], ((1, 1.5, 40), (2, 0.6, 110), (5, 0.4, 300)), 360)
write("screw", "x_mm", [rng.uniform(0, 60) for _ in range(90)], ((1, 0.8, 70), (2, 0.5, 200)), 5.3)
write("strobe", "x_mm", [7.0 * i for i in range(48)], ((1, 0.8, 90),), 2.4)
def reverse(name, backlash, opening):
    rng.seed(name)
    with open(name + ".csv", "w") as out:
        out.write("x_mm,direction,room_C,error_um\n")
        for i in range(60):
            x, sense = (i, 1) if i < 30 else (59 - i, -1)
            half = sense / 2 * (backlash + opening * (1 - (x / 14.5 - 1) ** 2))
            out.write(f"{x},{'up' if sense > 0 else 'down'},{rng.gauss(20, 1):.2f},{5 + 0.02 * x + half + rng.gauss(0, 0.15):.4f}\n")
reverse("backlash", 0.5, 0)
reverse("hysteresis", 0, 0.8)
write("clean", "angle_deg", [7.5 * i for i in range(48)], (), 360)
P
python3 made.py

look() { # look NAME COLUMN OPTIONS...
  local name=$1 column=$2
  shift 2
  "$program" loop --table $name.csv --response error_um --model "1 + $column" "$@" -o $name.json --html $name.html --model-out $name.model.json || fail "$name: exit code"
  valid loop.schema.json $name.json
  valid loop_model.schema.json $name.model.json
  value $name.json "next(i for i, c in enumerate(r['claims']) if c['id'] == 'table.periodic')" >at || fail "$name: no cycle"
  at=$(cat at)
}
order() { # order NAME ORDER MEMBER
  value "$1.json" "next(o['$3'] for o in r['claims'][$at]['orders'] if o['order'] == $2)"
}

# Places taken in turn: the cycle is an order of the angle's turn, and the runs say the same.
python3 -c 'import math, random
rng = random.Random(8)
print("run,angle_deg,error_um")
for i in range(72): print(f"{i + 1},{5 * i},{1.8 * math.cos(math.radians(15 * i - 40)) + rng.gauss(0, 0.6):.3f}")' >even.csv
"$program" loop --table even.csv --response error_um --model 1 -o even.json || fail "even: exit code"
value even.json "r['summary']" | grep -q "over angle_deg that returns every 120° (order 3 of 360°).*cannot tell from: a periodic change over the runs" ||
  fail "places taken in turn: $(value even.json "r['summary']")"

look turn angle_deg
[ "$(value turn.json "[o['order'] for o in r['claims'][$at]['orders']]")" = "[1, 2, 5]" ] || fail "orders of a turn: $(cat turn.json)"
[ "$(value turn.json "r['claims'][$at]['base_period']")" = known ] || fail "the turn of an angle is not known"
near "period" "$(value turn.json "r['claims'][$at]['parameters']['period']")" 360 0
near "order 1" "$(order turn 1 amplitude)" 1.5 0.17
near "order 2" "$(order turn 2 amplitude)" 0.6 0.1
near "phase of 1" "$(order turn 1 phase_deg)" 40 6
near "phase of 5" "$(order turn 5 phase_deg)" 300 20
near "peak of 5" "$(order turn 5 peak_at)" 204 4
value turn.json "[c['name'] for c in r['claims']]" | grep -q "table.factor(way)" || fail "the backlash is not seen"
grep -q "that returns every 360°, in its orders 1, 2 and 5" turn.html || fail "the page does not name the orders"

look screw x_mm
near "lead" "$(value screw.json "r['claims'][$at]['parameters']['period']")" 5.3 0.02
[ "$(value screw.json "[o['order'] for o in r['claims'][$at]['orders']]")" = "[1, 2]" ] || fail "orders of a screw"
[ "$(value screw.json "r['claims'][$at]['base_period']")" = sought ] || fail "the lead was not sought"
near "u of the lead" "$(value screw.json "r['claims'][$at]['uncertainty']['period']")" 0.008 0.005

# A lead that is shorter than the places are apart: known, it is found by its own name.
look strobe x_mm --period x_mm=2.4
near "strobed amplitude" "$(order strobe 1 amplitude)" 0.8 0.12
near "declared" "$(value strobe.json "r['claims'][$at]['parameters']['period']")" 2.4 0

for name in backlash hysteresis; do
  expect 0 "" "$program" loop --table $name.csv --response error_um --model "1 + x_mm" -o $name.json --html $name.html
done
[ "$(value backlash.json "[c['name'] for c in r['claims']]")" = "['table.factor(direction)']" ] || fail "backlash"
[ "$(value hysteresis.json "[c['name'] for c in r['claims']]")" = "['table.hysteresis(x_mm, direction)']" ] || fail "hysteresis"
near "opening" "$(value hysteresis.json "2 * r['claims'][0]['parameters']['coefficient_2']")" 0.8 0.17
near "closing" "$(value hysteresis.json "2 * r['claims'][0]['parameters']['coefficient_1']")" 0 0.25
value hysteresis.json "r['claims'][0]['sentence']" | grep -qE "in the middle of the range of x direction up reads 0.[0-9 ±.]+ µm higher than direction down, at its ends" ||
  fail "the sentence of a hysteresis"
grep -q "As measured, and as the model has it" hysteresis.html || fail "the page lacks the data with the fit"

expect 0 "" "$program" loop --table clean.csv --response error_um --model "1 + angle_deg + way" -o clean.json
[ "$(value clean.json "r['verdict']")" = clean ] || fail "a clean table is not clean"

# The model file takes the cycle out of the table.
"$program" doe turn.csv --response error_um --model turn.model.json -o doe.json || fail "doe --model"

many=()
for i in $(seq 17); do many+=(--period "x_mm=$i"); done
refuse() {
  expect 64 "$1" "$program" loop --table screw.csv --response error_um --model "1 + x_mm" "${@:2}" -o never.json
}
refuse "COLUMN=P" --period x_mm
refuse "COLUMN=P" --period =3
refuse "above 0" --period x_mm=-2
refuse "above 0" --period x_mm=2mm
refuse "no column of numbers" --period way=2
refuse "no column of numbers" --period z=2
refuse "tell no order" --period x_mm=1e9
refuse "period: at most" "${many[@]}"
[ -e never.json ] && fail "a refused period leaves an output file"
# A bend over the order of the bumps is no cycle that returns after a thousand of them; a turn over nine bumps is one.
cat >bends.py <<'P'
import math, random
rng = random.Random()
for name, g in (("valley", lambda b: 4 * ((b - 6) / 3) ** 2 / 3), ("hinge", lambda b: 2 * max(0, b - 6) / 3),
                ("turn9", lambda b: math.sin(2 * math.pi * b / 9 + 1))):
    rng.seed(f"x{name}2")
    with open(name + ".csv", "w") as out:
        out.write("foil,bump,y\n")
        for foil in range(13):
            own = rng.gauss(0, 0.3)
            for b in range(1, 10):
                out.write(f"{foil + 1},{b},{own + g(b) + rng.gauss(0, 0.8):.4f}\n")
P
python3 bends.py
for name in valley hinge turn9; do
  "$program" loop --table $name.csv --response y --model 1 --order bump -o $name.json || fail "$name: exit code"
  value $name.json "[c['parameters']['period'] for c in r['claims'] if c['id'] == 'table.periodic']" >period || fail "$name: $(cat $name.json)"
  if [ $name = turn9 ]; then
    near "period of a turn" "$(tr -d '[]' <period)" 9 0.3
  else
    grep -qF '[]' period || fail "a $name returns every $(cat period) bumps"
  fi
done

exit $failed
