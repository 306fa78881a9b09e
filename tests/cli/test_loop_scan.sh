#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on scans: clean renders are clean, known effects are named and taken out, a model carries
# over to another foil, and what does not fit together is refused.
. tests/support/loop.sh

# render NAME SEED ROTATION EFFECTS
render() { render_foil "$@" 2400; }

render clean 1 -70 ''
expect 0 "note: nothing.json: nothing was found of the scanner" "$program" loop clean.png -o clean.out --model-out nothing.json
expect 0 '' "$program" measure clean.png --model nothing.json -o nothing.out
[ "$(value clean.out "r['noise']['form'], r['noise']['sd'] == r['noise']['white_sd'] == r['noise_floor']")" = "('white', True)" ] ||
  fail "the noise of a clean scan is $(value clean.out "r['noise']")"
value clean.out "r['summary']" | grep -q '^Nothing is claimed: ' || fail "a clean scan is summed up as $(value clean.out "r['summary']")"
[ "$(value clean.out "r['verdict']")" = clean ] || fail "a clean scan is called $(value clean.out "r['verdict']")"

render ripple 2 -60 '{"id":"scan.carriage_ripple","amplitude_um":7,"period_mm":2.7,"phase_deg":30}'
"$program" loop ripple.png -o ripple.out || fail "loop on a ripple"
[ "$(value ripple.out "r['claims'][0]['id']")" = scan.carriage_ripple ] || fail "the ripple is not named"
value ripple.out "r['summary']" | grep -q '^Found: .*ripple.* falls from ' || fail "a ripple is summed up as $(value ripple.out "r['summary']")"
[ "$(value ripple.out "r['error_ratio']['folds'], r['error_ratio']['fold_of'], r['error_ratio']['held_out'] < 0.1, r['error_ratio']['held_out'] > 0.9 * r['error_ratio']['rms']")" = "(5, 'bumps', True, True)" ] ||
  fail "cross-fitted the ripple leaves $(value ripple.out "r['error_ratio']")"
[ "$(value clean.out "all(0 < x['rms_before'] == x['held_out_rms_before'] == x['held_out_rms_after'] for x in r['bumps']['responses'][:2])")" = True ] ||
  fail "the bumps of a clean scan have the errors $(value clean.out "r['bumps']")"
[ "$(value clean.out "r['error_ratio']")" = "{'rms': 1, 'held_out': 1, 'folds': 0, 'fold_of': None}" ] || fail "a clean scan's errors change: $(value clean.out "r['error_ratio']")"
near amplitude "$(value ripple.out "r['claims'][0]['parameters']['amplitude_um']")" 7 0.05
near period "$(value ripple.out "r['claims'][0]['parameters']['period_mm']")" 2.7 0.003
near R0 "$(value ripple.out "r['after']['foils'][0]['overall']['radius_mm']")" 20.95 0.0001
near R "$(value ripple.out "r['after']['foils'][0]['bumps'][3]['radius_mm']")" 3.44 0.001

if ! brief; then
# Two steps at seams of the sensor are two steps, and nothing that the first one made needless; bumps of every third
# number that stand out are a pattern that no effect is named for.
render gaps 9 -80 '{"id":"scan.column_step","x_mm":15.2,"amplitude_um":9},{"id":"scan.column_step","x_mm":28.6,"amplitude_um":-6}'
render every 8 -65 '{"id":"free.bump.index","amplitude_um":12,"every":3}'
for name in gaps every; do "$program" loop $name.png -o $name.out || fail "loop on $name"; done
[ "$(value gaps.out "[c['id'] for c in r['claims']]")" = "['scan.column_step', 'scan.column_step']" ] ||
  fail "two column steps are called $(value gaps.out "[c['id'] for c in r['claims']]")"
[ "$(value every.out "len(r['claims']), r['unattributed']['coordinate']")" = "(0, 'bump.index')" ] ||
  fail "every third bump is $(value every.out "r['verdict'], [c['id'] for c in r['claims']]")"
fi

# One foil, scanned twice, turned by 90 degrees: the scanner's scale is told from an oval foil.
render a 3 -75 '{"id":"scan.scale_y","value":0.001}'
render b 4 15 '{"id":"scan.scale_y","value":0.001}'
"$program" loop --same-foil a.png b.png -o pair.out --model-out scanner.json || fail "loop on a pair"
[ "$(value pair.out "len(r['claims'])")" = 1 ] || fail "a pair with one effect has other claims"
[ "$(value pair.out "r['claims'][0]['id'] + ' ' + r['claims'][0]['verdict']")" = "scan.scale_y found" ] ||
  fail "the scale is not named from a pair"
near scale "$(value pair.out "r['claims'][0]['parameters']['value']")" 0.001 0.000002

# An oval foil is named from a pair, and its dimensions stay as measured: the deviation is its form.
reports="clean ripple pair"
if ! brief; then
reports="$reports oval"
render oval_a 5 -75 '{"id":"part.ovality","amplitude_um":12,"phase_deg":20}'
render oval_b 6 15 '{"id":"part.ovality","amplitude_um":12,"phase_deg":20}'
"$program" loop --same-foil oval_a.png oval_b.png -o oval.out || fail "loop on an oval pair"
[ "$(value oval.out "r['claims'][0]['id']")" = part.ovality ] || fail "the ovality is not named from a pair"
cat >same.py <<'PYTHON'
import json

# Unseen causes of the scanner are in u, and in nothing else.
def is_of_u(key):
    return key.startswith("u_") or "covariance" in key or key.endswith("_limits") or key == "judgements"

def numbers(at):
    if isinstance(at, dict):
        return [x for k in sorted(at) if k != "corrections" and "form_error" not in k and not is_of_u(k) for x in numbers(at[k])]
    return [x for y in at for x in numbers(y)] if isinstance(at, list) else [at]

r = json.load(open("oval.out"))
before, after = numbers(r["before"]["foils"]), numbers(r["after"]["foils"])
assert len(before) == len(after) > 60, len(after)
for x, y in zip(before, after):
    assert x == y or abs(x - y) <= 1e-8 * abs(x), (x, y)
assert r["error_ratio"]["rms"] < 0.1, r["error_ratio"]
PYTHON
python3 same.py || fail "the form of an oval foil is subtracted from its dimensions"
fi

for report in $reports; do valid loop_scan.schema.json $report.out; done

# The scanner's model corrects another foil.
render other 7 -120 '{"id":"scan.scale_y","value":0.001}'
"$program" measure other.png -o plain.out && "$program" measure other.png --model scanner.json -o corrected.out ||
  fail "measure with a model"
near "corrected R0" "$(value corrected.out "r['foils'][0]['overall']['radius_mm']")" 20.95 0.0002
before=$(value plain.out "abs(r['foils'][0]['overall']['radius_mm'] - 20.95)")
after=$(value corrected.out "abs(r['foils'][0]['overall']['radius_mm'] - 20.95)")
python3 -c "import sys; sys.exit(float(sys.argv[1]) * 10 > float(sys.argv[2]))" "$after" "$before" ||
  fail "the model takes the error of R0 from $before only to $after mm"

# expect CODE WORDS ARGUMENTS...
expect() {
  local code=$1 words=$2
  shift 2
  "$program" "$@" >out.txt 2>err.txt </dev/null
  local got=$?
  [ $got -eq "$code" ] || fail "$*: exit code $got, not $code"
  grep -q -- "$words" err.txt || fail "$*: does not say '$words' but: $(cat err.txt)"
}

sed 's/2400/1200/' a.json >half.json && "$renderer" render half.json -o half.png || fail "render at 2400 dpi"
expect 65 "one resolution" loop a.png half.png
expect 64 "given twice" loop a.png --hold-out a.png
expect 64 "give a scan" loop
expect 64 "a whole number" loop a.png --seed 1e3
expect 64 "not a number from 1 to 1024" loop a.png --threads 0
expect 64 "not a number from 1 to" loop a.png --dpi inf
render third 8 -70 ''
sed -i 's/3.34,3.41/4.24,3.41/' third.json && "$renderer" render third.json -o third.png || fail "render another foil"
expect 65 "not the same foil" loop --same-foil a.png third.png
printf '{"schema":"foilgauge/design/1"}' >wrong.json
expect 65 "not a model of a scanner" measure a.png --model wrong.json
expect 65 "1200 dpi" measure half.png --model scanner.json -o never.json
[ ! -e never.json ] || fail "a refused model leaves a report behind"
expect 74 "" loop a.png -o /nowhere/x.json

exit $failed
