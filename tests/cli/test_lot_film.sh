#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# `"film"` in a lot's recipe: gas film and threshold speed of bearings drawn from its foils, in report and page; the same bearings as
# `foilgauge film --foils` draws from the lot, the same of shards; a load that no film carries is said.
. tests/support/cli.sh
listened="stdout stderr"
echo '{"schema": "foilgauge/design/1", "bump_count": 3}' >design.json
for foil in 1 2 3 4; do
  printf '{"schema":"foilgauge/render/1","seed":%d,"foils":[{"design":{"bump_count":3},"overall_radius_mm":20.74,
"radius_springback":{"mean":0.002,"sd":0.002},"rotate_deg":-90}],"scanner":{"dpi":1200,"blur_px":1.0,"noise":1}}' $foil >spec.json
  "$renderer" render spec.json -o "foil$foil.png" || fail "render"
done
film='"load_n": 10, "speed_rpm": 25000, "rotor_mass_kg": 0.04, "bearings": 12, "cells_per_bump": 4, "cells_axial": 4'
recipe() { # recipe NAME FILM
  echo '{"schema":"foilgauge/recipe/1","design":"design.json","resamples":1000,"pads":3,"bumps_per_pad":3,"film":{'"$2"'}}' >"$1"
}
recipe recipe.json "$film"
expect 0 "4 foils" "$program" lot foil*.png -o lot --recipe recipe.json
valid lot.schema.json lot/lot.json
valid recipe.schema.json lot/recipe.json
grep -q 'The rotor on bearings of this lot' lot/index.html && grep -q 'threshold speed' lot/index.html || fail "the page has no film"
expect 0 "" "$program" film design.json --load 10 --speed 25000 --mass 0.04 --foils lot --draws 12 --mesh 4,4 --within 10 --pads 3 --bumps 3 -o film.json
checks - lot/lot.json film.json <<'END' || fail "the lot's film"
import json, sys
lot, film = json.load(open(sys.argv[1]))["film"], json.load(open(sys.argv[2]))
assert lot["threshold_rpm"] == film["threshold_rpm"] and lot["threshold_rpm"] > 10000, (lot["threshold_rpm"], film["threshold_rpm"])
assert lot["tolerance"] == film["tolerance"], (lot["tolerance"], film["tolerance"])
assert lot["draws"]["foils"] == 4 and lot["draws"]["count"] == 12
for share in ("solved", "touching", "within", "not_lower"):
    assert lot["draws"][share] == film["draws"][share], share
for name, value in lot["draws"]["mass_over_perfect"].items():  # a table has fewer digits
    other = film["draws"]["mass_over_perfect"][name]
    assert (value is None) == (other is None) and (value is None or abs(value / other - 1) < 1e-5), (name, value, other)
END

# Shards, merged: the same report.
for shard in 1 2; do
  expect 0 "" "$program" lot foil*.png -o part$shard --recipe recipe.json --shard $shard/2 --pages none
done
expect 0 "" "$program" merge part1 part2 -o whole
python3 -c "
import json
a, b = (json.load(open(n + '/lot.json'))['film'] for n in ('lot', 'whole'))
assert a == b, (a, b)" || fail "a merged lot has another film"

# No film at this load, and recipes that ask for none: said, and never an error of the lot.
recipe heavy.json "${film/\"load_n\": 10/\"load_n\": 30000}"
expect 0 "" "$program" lot foil*.png -o heavy --recipe heavy.json --pages none
grep -q 'No film was found: .*has no film at 30000 N' heavy/index.html || fail "a load without a film is not said"
[ "$(value heavy/lot.json "r['film']")" = None ] || fail "a film at a load without one"
expect 0 "" "$program" lot foil*.png -o without --design design.json --pages none
grep -q '"film"' without/lot.json without/recipe.json && fail "a film that nobody asked for"
recipe slow.json '"load_n": 30'
expect 65 "film.speed_rpm is missing" "$program" lot foil*.png -o never --recipe slow.json
recipe odd.json "${film/bump\": 4/bump\": 5}"
expect 65 "must be even" "$program" lot foil*.png -o never --recipe odd.json
exit $failed
