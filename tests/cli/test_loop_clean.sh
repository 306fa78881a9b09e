#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A rough foil without any effect, of which the search that comes first takes the roughness for a curve: the evidence says
# that there is none, and the report is clean.
. tests/support/loop.sh

cat >rough.json <<'SPEC'
{"schema": "foilgauge/render/1", "seed": 214898534,
 "foils": [{"overall_radius_mm": 21.09250528674699, "rotate_deg": 56.940441028474595, "mirror": true,
            "radius_mm": [3.36008142311845, 3.325752838416115, 3.309475924212362, 3.335518726826436, 3.3710163668498447,
                          3.351498266615027, 3.375711419702396, 3.432302187060753, 3.3602137336858755]}],
 "scanner": {"dpi": 2400, "blur_px": 1.099777600149475, "noise": 1.0,
             "rough": {"edge_roughness_um": 1.2, "edge_common_um": 0.6, "correlation_um": 36.07191950781021,
                       "correlation_form": "gaussian"}}}
SPEC
"$renderer" render rough.json -o rough.png || fail "render"
"$program" loop rough.png -o rough.out || fail "loop on a rough foil"
[ "$(value rough.out "r['verdict'], r['claims'], r['unattributed']")" = "('clean', [], None)" ] ||
  fail "a foil without an effect is $(value rough.out "r['verdict']")"
[ "$(value rough.out "[n for n in r['notes'] if 'in no fit' in n]")" = "[]" ] || fail "a fillet of a rough foil is told as a crease"

# A crease of a land passes for its fillets: no fit holds it, and the report says so beside its verdict.
render_foil creased 5 -70 '{"id":"part.dent","amplitude_um":20,"place_deg":6.6,"width_deg":0.35,"along":"normal"}' 2400
"$program" loop creased.png -o creased.out || fail "loop on a creased foil"
[ "$(value creased.out "[n[:34] for n in r['notes'] if 'in no fit' in n]")" = "['creased.png foil 1: beside bump 5 ']" ] ||
  fail "nothing says that the foil is creased: $(value creased.out "r['notes']")"
exit $failed
