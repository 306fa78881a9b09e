#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `foilgauge stiffness`: records as rigs give them: units of other trades, an instrument at the end of its range, loops on
# the way, strokes of one sense, a displacement that jumps. Known truth, of foils with play operators.
. tests/support/cli.sh
skip_when_slow # the other tests of load tests see the same code
run() { expect "$1" "$2" "$program" stiffness --azimuth 0 "${@:3}"; }

cat >make.py <<'END'
import random
N, C, HALF, SHARES, WIDTHS = 1.2, 8 / 0.010**1.2, 0.080, (0.03, 0.05), (0.0004, 0.0012)
END = HALF + 0.010 * 10 ** (1 / N)  # 80 N

def record(places):
    """Displacement and force along a way over these places, in mm and N."""
    x, play, rows = 0.0, [[0.0, 0.0], [0.0, 0.0]], []
    def press(foil, y):
        y = max(y, 0.0)
        play[foil] = [min(max(p, y - r), y + r) for p, r in zip(play[foil], WIDTHS)]
        return max(0.0, C * y**N * (1 + sum(a * (y - p) / r for a, p, r in zip(SHARES, play[foil], WIDTHS))))
    for place in places:
        sense = 1 if place > x else -1
        while sense * x < sense * place:
            x += sense * 2e-4
            rows.append((x, press(0, x - HALF) - press(1, -x - HALF)))
    rng = random.Random(4)
    return [(a + rng.gauss(0, 1e-4), b + rng.gauss(0, 0.05)) for a, b in rows[::4]]

def write(name, rows, names="displacement_mm,force_N", scale=(1, 1)):
    with open(name, "w") as out:
        print(names, *(f"{x * scale[0]:.7f},{f * scale[1]:.6f}" for x, f in rows), sep="\n", file=out)

whole = [END, -END] * 3 + [0]
plain = record(whole)
write("plain.csv", plain)
write("kgf.csv", plain, "displacement_mil,force_kgf", (1 / 0.0254, 1 / 9.80665))
write("lbf.csv", plain, "displacement_in,force [lbf]", (1 / 25.4, 1 / 4.4482216152605))
write("force_ends.csv", [(x, max(-50.0, min(50.0, f))) for x, f in plain])
write("place_ends.csv", [(min(x, 0.090), f) for x, f in plain])
write("up.csv", [b for a, b in zip(plain, plain[1:]) if b[0] > a[0]])
way, near = 0.005, END - 0.010
write("loops.csv", record(sum(([near] + [near - way, near] * 4 + [END, -near] + [way - near, -near] * 4 + [-END] for _ in range(3)), []) + [0]))
write("jump.csv", [(x + 0.020 * (2 * i > len(plain)), f) for i, (x, f) in enumerate(plain)])
END
python3 make.py
of() { value "$1.json" "r['azimuths'][0]['$2']"; }
# within NAME MEMBER: its U holds what the plain record has.
within() {
  python3 -c 'import sys; a, u, b = map(float, sys.argv[1:]); sys.exit(not abs(a - b) <= 2 * u)' \
    "$(of "$1" "$2")" "$(of "$1" "u_repeat_$2")" "$(of plain "$2")" || fail "$1: $2 is $(of "$1" "$2"), not $(of plain "$2")"
}
for name in plain kgf lbf force_ends place_ends loops jump; do run 0 "" $name.csv -o $name.json; done
for name in kgf lbf; do
  python3 -c 'import sys; a, b = map(float, sys.argv[1:]); sys.exit(not abs(a / b - 1) < 0.002)' \
    "$(of $name stiffness_n_mm)" "$(of plain stiffness_n_mm)" || fail "$name: another stiffness"
  within $name clearance_mm
done
run 65 "'lb' is no unit of force but of mass" <(sed '1s/N/lb/' plain.csv)

# Beyond an instrument's range nothing is known: no loops, and the contact is where it was.
for name in force_ends place_ends; do
  of $name flags | grep -q saturated || fail "$name: not flagged"
  [ "$(of $name loss_factor)$(of $name loss_factor_foil)" = NoneNone ] || fail "$name: a loss factor of loops that were not seen"
  within $name clearance_mm
done
[ "$(of plain flags)" = "['stiffness_at_end']" ] || fail "the plain record is flagged: $(of plain flags)"

# Loops of friction on the way are no part of the branches: the stiffness was 2599 N/mm where 1512 are true.
of loops flags | grep -q loops_on_the_way || fail "loops: not flagged"
for member in clearance_mm stiffness_n_mm loss_factor loss_factor_foil; do within loops $member; done

# A displacement that jumps by 20 um in the gap: U of the loss factor holds the truth.
within jump loss_factor
within jump loss_factor_foil

run 2 "" up.csv -o up.json
of up flags | grep -q one_sense || fail "up: $(of up flags)"
valid load_test.schema.json loops.json force_ends.json up.json
exit $failed
