#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The best setting of `foilgauge doe`: factors that cannot be told from noise take no part in it, and terminal, page
# and JSON say the same of how far to trust it.
. tests/support/cli.sh
skip_when_slow # test_doe.sh sees the same code

# A central composite of three factors: pressure does nothing, duration and temperature have a minimum within. The
# scatter is a fixed column of normal deviates. Beside it the same runs with a die, of two words, that does nothing, and
# responses of scatter alone.
cat >made.py <<'P'
import itertools, random
points = list(itertools.product((-1, 1), repeat=3)) + [(0, 0, 0)] * 6
points += [tuple(s if i == k else 0 for i in range(3)) for k in range(3) for s in (-1.682, 1.682)]
for seed in range(50):  # draws in which the scatter of the pressure is neither large nor nothing
    rng = random.Random(seed)
    noise = [rng.gauss(0, 1) for _ in points]
    slope = sum(p[0] * e for p, e in zip(points, noise)) / sum(p[0] ** 2 for p in points)
    own = sum(p[0] ** 2 * e for p, e in zip(points, noise)) / 20 - sum(noise) / 20
    if 0.15 < abs(slope) < 0.25 and abs(own) < 0.1:
        break
with open("ccd.csv", "w") as out:
    out.write("run,pressure_bar,temperature_C,duration_h,die,springback_um,flat\n")
    for i, ((p, t, d), e) in enumerate(zip(points, noise)):
        y = 50 - 8 * t + 6 * t * t + 3 * t * d + 5 * d * d - 2 * d + e
        out.write(f"{i + 1},{20 + 4 * p:.4f},{600 + 50 * t:.4f},{4 + d:.4f},{'AB'[i % 2]},{y:.4f},{7 + e:.4f}\n")
with open("linear.csv", "w") as out:  # all three matter, and the best is at the corner
    out.write("a,b,y\n")
    for i, ((a, b), e) in enumerate(zip(list(itertools.product((-1, 1), repeat=2)) * 2, noise)):
        out.write(f"{a},{b},{20 - 5 * a - 3 * b + e / 9:.4f}\n")
    out.write("0,0,24\n0,0,24.1\n0,0,23.9\n")
P
python3 made.py
squares='(pressure_bar+temperature_C+duration_h)^2 + pressure_bar^2 + temperature_C^2 + duration_h^2'

# terminal NAME COMMAND...: what a terminal shows, as one line, into NAME.txt
terminal() {
  local name=$1
  shift
  script -qec "$(printf '%q ' "$@")" /dev/null </dev/null | tr -d '\r' | tr '\n' ' ' | tr -s ' ' >"$name.txt"
}

# analyse NAME TABLE RESPONSE MODEL OPTION...: NAME.json, NAME.html (without tags, as one line) and NAME.txt
analyse() {
  local name=$1
  local arguments=(doe "$2" --response "$3" --model "$4" "${@:5}")
  expect 0 '' "$program" "${arguments[@]}" -o "$name.json" --html "$name.page.html"
  valid doe.schema.json "$name.json"
  terminal "$name" "$program" "${arguments[@]}"
  python3 -c "import html,re,sys; t = re.sub(r'<style.*?</style>|<svg.*?</svg>', '', sys.stdin.read(), flags=re.S)
print(' '.join(html.unescape(re.sub('<[^>]+>', ' ', t)).split()))" <"$name.page.html" >"$name.html"
  # Whatever is said of the best setting stands in all three.
  checks - "$name" <<'P' || fail "$name: terminal, page and JSON differ"
import json, sys
name = sys.argv[1]
said = json.load(open(name + ".json"))["conclusions"]
terminal, page = open(name + ".txt").read(), open(name + ".html").read()
for text in said:
    words = " ".join(text.split())
    assert words in terminal, ("terminal", words)
    if not words.startswith("Best setting"):
        assert words in page, ("page", words)
for border in ("It lies on the border", "It lies inside the region", "It lies on a constraint"):
    there = [border in " ".join(said), border in terminal, border in page]
    assert len(set(there)) == 1, (border, there)
P
}

# The pressure is not sent to an edge; the optimum is that of the model without it.
analyse noise ccd.csv springback_um "$squares"
grep -q 'pressure any (cheapest will do), temperature' noise.html || fail "the page sends the pressure somewhere"
grep -q 'pressure [0-9.]* bar' noise.html && fail "a pressure in bar"
grep -q 'pressure cannot be told from the scatter (p = [0-9.]*, its terms together)' noise.txt || fail "why any"
grep -q 'It lies inside the region of the runs' noise.txt || fail "the terminal does not say that it is inside"
analyse without ccd.csv springback_um 'temperature_C*duration_h + temperature_C^2 + duration_h^2'
checks - <<'P' || fail "the optimum is not that of the model without the pressure"
import json
noise, without = (json.load(open(n + ".json"))["surface"] for n in ("noise", "without"))
assert [a["name"] for a in noise["any"]] == ["pressure_bar"] and noise["any"][0]["terms"] == 4, noise["any"]
assert 0.05 < noise["any"][0]["p_value"] <= 1 and without["any"] == []
for part in ("axes", "formula", "kind"):
    assert noise[part] == without[part], part
for part in ("optimum", "stationary"):
    for member in ("coded", "real", "mean", "standard_error"):
        assert noise[part][member] == without[part][member], (part, member)
    # The runs chose the factors, too: the intervals hold for all models to choose from.
    assert noise[part]["coverage_factor"] > without[part]["coverage_factor"], part
P

# A factor of words, steps, and constraints that hold an idle factor.
analyse die ccd.csv springback_um "$squares + die" --round temperature_C=10 --round pressure_bar=1 \
  --constraint '3*pressure_bar + temperature_C <= 660'
grep -q 'pressure any that the constraints allow (cheapest will do), temperature 620 °C' die.html || fail "steps"
grep -q 'die any (cheapest will do)' die.html || fail "the die is not any"
[ "$(value die.json 'r["surface"]["optimum"]["real"][0] <= 660 - 3 * 13.272')" = True ] || fail "the constraint is lost"
grep -q 'It lies on a constraint' die.txt || fail "what holds the optimum is not said"

# On the border without steps, within it with them: one answer.
analyse corner linear.csv y 'a + b' --goal lowest
grep -q 'It lies on the border of the region' corner.txt || fail "the border is not said"
analyse inner linear.csv y 'a + b' --goal lowest --round a=0.7 --round b=0.7
grep -q 'It lies on the border of the region' inner.html || fail "the page of a rounded setting hides the border"

# No factor matters: no setting is made up, and what the model leads to is called a test.
analyse flat ccd.csv flat 'temperature_C + duration_h'
grep -q 'No best setting' flat.html || fail "a best setting out of scatter"
grep -q 'temperature any (cheapest will do), duration any (cheapest will do)' flat.txt || fail "not any"
[ "$(value flat.json 'len(r["surface"]["any"])')" = 2 ] || fail "any of the JSON"

# A setting that is asked for: eq 5.4 of the thesis at its optimum of 675 degrees, which it does not make one.
analyse at "$root/samples/doe/springback_composite.csv" springback_error_pct \
  'temperature_C*duration_h + temperature_C^2 + duration_h^2' --code temperature_C=400:700 --code duration_h=1:7 \
  --at 'temperature_C=675, duration_h=4' --at 'duration_h = 5,temperature_C=650' --at 'temperature_C=720,duration_h=4'
grep -q 'Asked for: at temperature 675 °C, duration 4 h the model as given expects 3.78. %' at.html || fail "what is expected"
grep -q 'not the best along each factor by itself: 3.72 % at temperature 693.8 °C' at.txt || fail "what is better along T"
[ "$(value at.json '[round(a["mean"], 2) for a in r["asked"]] + [a["inside_runs"] for a in r["asked"]]')" = \
  '[3.78, 5.25, 3.84, True, True, False]' ] || fail "asked: $(value at.json '[a["mean"] for a in r["asked"]]')"
grep -q 'It lies beyond the runs' at.txt || fail "an extrapolation is not told"
for wrong in 'temperature_C=675' 'temperature_C 675, duration_h=4' 'temp=675, duration_h=4' \
  'temperature_C=hot, duration_h=4' 'temperature_C=675, duration_h='; do
  expect 64 "--at '" "$program" doe "$root/samples/doe/springback_composite.csv" --response springback_error_pct \
    --model 'temperature_C*duration_h' --at "$wrong" -o wrong.json
done

# Axial runs are not asked of a plan that has them.
coding=(--code temperature_C=550:650 --code duration_h=3:5 --code pressure_bar=16:24)
analyse axial ccd.csv springback_um 'temperature_C + duration_h + pressure_bar' "${coding[@]}"
grep -q 'the response is curved; the plan has runs beyond corners and centre' axial.txt || fail "axial runs of the plan"
analyse squared ccd.csv springback_um "$squares" "${coding[@]}"
grep -q 'the response is curved; the squares of the model say in which factor' squared.txt || fail "squares of the model"
(head -n 1 ccd.csv; awk -F, '$2 ~ /^(16|24|20)\./ && $3 ~ /^(550|650|600)\./ && $4 ~ /^[345]\./' ccd.csv |
  awk -F, '($2 == "20.0000") == ($3 == "600.0000") && ($3 == "600.0000") == ($4 == "4.0000")') >corners.csv
analyse corners corners.csv springback_um 'temperature_C + duration_h + pressure_bar'
grep -q 'the response is curved; axial runs would tell in which factor' corners.txt || fail "no axial runs here"

# Units that differ by many powers of ten: the same optimum, coded or not, and inside where it lies inside.
python3 - <<'P'
import random
rng, points = random.Random(3), [(-1, -1), (1, -1), (-1, 1), (1, 1), (0, 0), (0, 0), (0, 0)]
points += [(-1.4, 0), (1.4, 0), (0, -1.4), (0, 1.4)]
noise = [rng.gauss(0, 0.03) for _ in points]
with open("units.csv", "w") as out, open("valley.csv", "w") as valley:
    out.write("p_Pa,e_m,y\n")
    valley.write("T,D,y\n")
    for (a, b), e in zip(points, noise):
        out.write(f"{550 + 5e5 * a},{1e-4 + 2e-5 * b:.8f},{5 + 0.8 * (a - 0.5) ** 2 + 0.6 * (b + 0.3) ** 2 + e:.4f}\n")
        valley.write(f"{550 + 50 * a},{4 + b},{3 + 4 * (a - b) ** 2 + 0.3 * (a + b - 0.3) ** 2 + e:.4f}\n")
with open("days.csv", "w") as days, open("dies.csv", "w") as dies:
    days.write("day,T,P,y\n")
    dies.write("die,T,y\n")
    for i, day in enumerate((0, 3, -2, 1)):
        for a, b in points[:4]:
            days.write(f"d{i},{550 + 50 * a},{300 + 50 * b},{20 + day + 2 * a - b + rng.gauss(0, 0.3):.4f}\n")
            dies.write(f"{'ABAB'[i]},{550 + 50 * a},{20 + (1 if i % 2 else 4) * a + rng.gauss(0, 0.3):.4f}\n")
P
for goal in lowest 5.4; do
  for limit in '2e-6*p_Pa + 5e4*e_m <= 5.7' 'p_Pa <= 1e9'; do
    analyse coded units.csv y 'p_Pa*e_m + p_Pa^2 + e_m^2' --goal $goal --constraint "$limit"
    analyse real units.csv y 'p_Pa*e_m + p_Pa^2 + e_m^2' --goal $goal --constraint "$limit" --code none
    checks - "$goal" <<'P' || fail "the optimum depends on the units: $goal, $limit"
import json, sys
coded, real = (json.load(open(n + ".json"))["surface"]["optimum"] for n in ("coded", "real"))
assert abs(coded["mean"] - real["mean"]) < 1e-6, (coded, real)
assert coded["on_border"] == real["on_border"], (coded, real)
if sys.argv[1] == "lowest":
    assert abs(coded["real"][0] - real["real"][0]) < 10 and abs(coded["real"][1] - real["real"][1]) < 1e-9, (coded, real)
P
  done
done

# A factor without a step goes to its best beside the rounded one.
analyse stepped valley.csv y 'T*D + T^2 + D^2' --code T=500:600 --code D=3:5 --goal 4 --round T=30
[ "$(value stepped.json 'abs(r["surface"]["rounded"]["mean"] - 4) < 1e-3 and r["surface"]["rounded"]["real"][0] % 30 < 1e-6')" = \
  True ] || fail "the rounded setting misses a goal that it can reach: $(value stepped.json 'r["surface"]["rounded"]')"

# Expected responses are of the mean of the blocks.
analyse days days.csv y 'T*P' --block day
grep -q 'of the mean of these 4 blocks (day), which scatter with a standard deviation of 2\.[0-9]*\. A run in another' days.html ||
  fail "another block is not told of"

# An effect that differs between dies is said to be that of the first.
analyse dies dies.csv y 'T*die'
grep -q 'T matters (at die A): from 500 to 600 it raises the response by [78]\.' dies.txt || fail "the effect's die is not said"
analyse alike dies.csv y 'T + die'
grep -q 'T matters: from 500 to 600' alike.txt || fail "an effect of all dies is said to be of one"

# The duration followed the temperature from run to run, and it alone makes the response: 10 - 1.2 D. That the temperature
# seems to do it by chance does not set the duration free.
cat >followed.csv <<'END'
T,D,y
500,3.02,6.512
500,2.96,6.296
521.429,3.4,5.952
521.429,3.23,5.901
542.857,4,5.410
542.857,3.95,5.307
564.286,4.26,4.971
564.286,4.35,4.883
585.714,4.74,4.059
585.714,4.67,4.592
607.143,5.22,4.250
607.143,5.12,3.446
628.571,5.55,2.908
628.571,5.51,3.012
650,6.04,2.962
650,5.99,2.844
END
analyse followed followed.csv y 'T + D'
grep -q 'any (cheapest' followed.txt && fail "a setting is called free that follows another"
grep -q 'the settings of D follow those of the other factors in these runs (R² = 0.9942)' followed.html || fail "not told"
[ "$(value followed.json '(lambda o: o["interval"][0] < 10 - 1.2 * o["real"][1] < o["interval"][1])(r["surface"]["optimum"])')" = True ] ||
  fail "the interval at the best setting: $(value followed.json 'r["surface"]["optimum"]')"

# A combination that no run has.
printf 'die,oven,y\nA,x,1\nA,x,1.2\nA,z,3\nA,z,3.1\nB,x,2\nB,x,2.2\n' >cell.csv
expect 0 '' "$program" doe cell.csv --response y --model 'die*oven' -o cell.json
[ "$(value cell.json 'any("dieB:ovenz is 0 in every run: nothing is known of it" in n for n in r["notes"])')" = True ] || fail "an empty cell"
[ "$(value cell.json 'any("no run has die B with oven z: 0 of 1 numbers of the interaction die:oven can be told" in n for n in r["notes"])')" = True ] || fail "an empty cell is not named"
# Two of them, of which one is that of the first levels.
printf 'die,oven,y\nA,y,2\nA,y,2.1\nA,z,3\nA,z,3.1\nB,x,2\nB,x,2.2\nB,y,5\nB,y,5.1\nB,z,4\nB,z,4.3\nC,x,1\nC,x,1.1\nC,z,2\nC,z,2.2\n' >cells.csv
expect 0 '' "$program" doe cells.csv --response y --model 'die*oven' -o cells.json
[ "$(value cells.json 'any("no run has die A with oven x, die C with oven y: 2 of 4 numbers of the interaction die:oven can be told." in n for n in r["notes"])')" = True ] ||
  fail "two empty cells: $(value cells.json 'r["notes"]')"

exit $failed
