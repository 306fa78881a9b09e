#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# One verdict everywhere: exit code, JSON, CSV, page, terminal and lot say the same of a foil that passes, fails,
# cannot be told, lacks a bump, was not measured, or is no foil of the design.
shared=$(realpath -m "${FOILGAUGE_SHARED:-../shared}")
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh

render() { # NAME FOIL
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":4,\"foils\":[$2],\"scanner\":{\"dpi\":1200,\"noise\":2}}" >spec.json
  "$renderer" render spec.json -o "$1.png" || fail "render $1"
}
render three '{"design":{"bump_count":3},"radius_springback":{"mean":0.03,"sd":0.01}}'
render gap '{"design":{"bump_count":5},"missing":[3]}'
render short '{"design":{"bump_count":4}}'
render wide '{"design":{"bump_count":5,"overall_radius_mm":60,"sleeve_radius_mm":60,"pitch_deg":5}}'

design() { # COUNT TOLERANCES
  echo "{\"schema\":\"foilgauge/design/1\",\"bump_count\":$1,\"calibration\":\"not needed: the scan is rendered\",\"tolerances\":{$2}}" >design.json
}

# measure CODE SCAN OPTION...: a.json, a.csv and a.html of it.
measure() {
  local code=$1 scan=$2
  shift 2
  "$program" measure "$scan" -d design.json -o a.json --csv a.csv --html a.html "$@" 2>stderr
  local got=$?
  [ $got = "$code" ] || fail "exit $got, not $code: $scan $(cat design.json) $(cat stderr)"
}

# terminal SCAN: what a terminal shows of it, as a.txt.
terminal() {
  python3 -c 'import pty, sys; pty.spawn(sys.argv[1:])' "$program" measure "$1" -d design.json >a.txt
}

# holds FILE EXPRESSION...: of the report r and its first foil f.
holds() {
  python3 - "$@" <<'P' || fail "$1"
import json, sys
r = json.load(open(sys.argv[1]))
f = (r.get("foils") or [None])[0]
wrong = [e for e in sys.argv[2:] if not eval(e)]
print(*(f"not {e}" for e in wrong), sep="\n", end="")
sys.exit(1 if wrong else 0)
P
}
value() {
  python3 - "$1" "$2" <<'P'
import json, sys
r = json.load(open(sys.argv[1]))
f = r["foils"][0]
print(eval(sys.argv[2]))
P
}
says() { # FILE WORDS
  grep -qE -e "$2" "$1" || fail "$1 does not say '$2'"
}
silent() { # FILE WORDS
  grep -qE -e "$2" "$1" && fail "$1 says '$2'"
}
valid() {
  python3 -c 'import jsonschema' 2>/dev/null || return
  python3 "$root/tests/support/validate_schema.py" "$root/reports/schema" "$1" "$2" || fail "$2 is not valid"
}

# No tolerance: nothing is judged, and that is neither true nor false.
design 3 ''
measure 0 three.png
holds a.json 'r["verdict"] == f["verdict"] == "no_tolerance" and f["in_tolerance"] is None'
terminal three.png
says a.txt 'nothing is judged'
R0=$(value a.json 'f["overall"]["radius_mm"]') u=$(value a.json 'f["overall"]["u_radius_mm"]')
worst=$(value a.json 'max(f["bumps"], key=lambda b: b["radius_mm"])["radius_mm"]')
u_worst=$(value a.json 'max(f["bumps"], key=lambda b: b["radius_mm"])["u_radius_mm"]')
within() { # VALUE U SHARE: a limit that the value is above, by that share of u
  python3 -c "print(repr($1 - $3 * $2))"
}

# Everything passes.
design 3 '"overall.radius_mm":{"min":20,"max":22}'
measure 0 three.png
holds a.json 'f["in_tolerance"] is True and r["in_tolerance"] is True and r["counts"]["exceeded"] == 0'

# A limit within U, the value beyond it: cannot tell, in every place.
doubtful="\"overall.radius_mm\":{\"max\":$(within "$R0" "$u" 0.5)},\"radius_mm\":{\"max\":$(within "$worst" "$u_worst" 0.5)}"
design 3 "$doubtful"
measure 3 three.png
holds a.json 'f["in_tolerance"] is False and f["verdict"] == r["verdict"] == "cannot_tell"' \
  'not any(j["exceeded"] for j in f["judgements"]) and not any(b["flags"] for b in f["bumps"])' \
  'r["counts"] == {"exceeded": 0, "cannot_tell": 2, "not_measured": 0, "rejected": 0}'
says a.html 'class="verdict cannot_tell"'
says a.html 'Cannot tell \(2 values\)'
silent a.html 'tolerance is exceeded'
terminal three.png
says a.txt 'CANNOT TELL.* of 2 value'
silent a.txt 'OUT OF TOLERANCE|out_of_tolerance'
silent a.csv 'out_of_tolerance'
says a.csv ',cannot_tell,'

# The same with the limit on the other side.
design 3 "\"overall.radius_mm\":{\"max\":$(within "$R0" "$u" -0.5)}"
measure 3 three.png
holds a.json 'f["in_tolerance"] is False and r["counts"]["cannot_tell"] == 1'

# Two fail, one cannot be told: the same count everywhere.
design 3 "\"overall.radius_mm\":{\"max\":$(within "$R0" "$u" 0.5)},\"radius_mm\":{\"max\":$(within "$worst" "$u_worst" 9)},\"thickness_mm\":{\"max\":0.07}"
measure 1 three.png
holds a.json 'r["counts"]["exceeded"] == 2 == sum(j["exceeded"] for j in f["judgements"])' \
  'sum("out_of_tolerance" in b["flags"] for b in f["bumps"]) == 1 and f["in_tolerance"] is False'
terminal three.png
says a.txt 'OUT OF TOLERANCE: 2 value'
says a.html 'Out of tolerance \(2 values\)'

# A bump that is missing rejects a foil, with tolerances and without.
design 5 '"height_mm":{"min":0.1,"max":1}'
measure 1 gap.png
holds a.json 'f["verdict"] == "fail" and "missing_bump" in f["flags"] and "bump 3" in f["defect"]' \
  '[j["bump"] for j in f["judgements"] if j.get("missing")] == [3] and r["counts"]["exceeded"] == 0'
terminal gap.png
says a.txt 'REJECTED: bump 3 is missing'
says a.html 'class="verdict fail">Rejected'
says a.html 'bump 3 is missing'
valid measure.schema.json a.json
measure 1 short.png
holds a.json 'f["verdict"] == "fail" and f["defect"].startswith("bump 5 is missing")'
design 5 ''
measure 1 gap.png
terminal gap.png
says a.txt 'REJECTED: bump 3 is missing'
measure 0 short.png
holds a.json 'f["verdict"] == "no_tolerance" and f["defect"] is None and "bump_count" in f["flags"]'
design 3 '"height_mm":{"min":0.1,"max":1}'
measure 1 short.png
holds a.json 'f["defect"] == "4 bumps where the design has 3"'

# Not measured: no value, and none that could be taken for one.
design 3 '"height_mm":{"min":0.1,"max":1}'
measure 2 three.png --dpi 900
holds a.json 'f["in_tolerance"] is False and f["verdict"] == r["verdict"] == "not_measured"' \
  'f["overall"]["radius_mm"] is f["overall"]["u_radius_mm"] is f["overall"]["rms_um"] is None' \
  'f["thickness_mm"] is f["rotation_deg"] is f["noise_um"] is f["orientation"] is None'
says a.csv '^three.png,1,,[a-z_ ]*not_measured,,,,'
says a.csv ',not_measured,,not needed,[0-9]'
valid measure.schema.json a.json

[ -n "${FOILGAUGE_TEST_LONG-}" ] || exit $failed

# No foil of the design: the report names it, gives the reason, and is no success.
design 5 '"height_mm":{"min":0.1,"max":1}'
foreign() {
  holds a.json 'all("not_this_design" in g["flags"] and g["verdict"] == "not_measured" for g in r["foils"])' \
    'f["in_tolerance"] is False and f["overall"]["radius_mm"] > 41 and "design has" in f["error"]'
  says a.html 'no foil of the design'
  says a.html 'class="verdict not_measured">Not a foil of this design'
  says stderr 'no foil of the design'
  silent a.html 'td class="pass"'
}
measure 2 wide.png
foreign
terminal wide.png
says a.txt 'NOT MEASURED: no foil of the design'
valid measure.schema.json a.json
if [ -e "$shared/real/knife_scale_1200dpi.png" ]; then
  measure 2 "$shared/real/knife_scale_1200dpi.png" --dpi 1200
  foreign
fi

# A lot means the same, in one run, resumed and in shards.
lot() { # CODE VERDICT SCAN...
  local code=$1 verdict=$2
  shift 2
  rm -rf whole part merged
  mkdir part
  "$program" lot "$@" -d design.json -o whole 2>stderr
  local first=$?
  "$program" lot "$@" -d design.json -o whole --resume 2>/dev/null
  local resumed=$?
  for i in 1 2; do "$program" lot "$@" -d design.json -o part/$i --shard $i/2 2>/dev/null; done
  "$program" merge part/1 part/2 -o merged 2>/dev/null
  local merged=$?
  [ "$first $resumed $merged" = "$code $code $code" ] || fail "lot $*: exits $first $resumed $merged, not $code"
  holds whole/lot.json "r['verdict'] == '$verdict' and r['in_tolerance'] == ('$verdict' == 'pass')"
  cmp -s whole/lot.json merged/lot.json || fail "lot $*: merged is another: $(diff whole/lot.json merged/lot.json)"
  says whole/index.html "class=\"verdict $verdict\""
}
design 3 "$doubtful"
cp three.png again.png
lot 3 cannot_tell three.png again.png
holds whole/lot.json 'r["counts"]["cannot_tell"] == 2 and r["counts"]["exceeded"] == 0'
says whole/results.qif 'INDETERMINATE'
silent whole/bumps.csv out_of_tolerance
design 3 '"height_mm":{"min":0.1,"max":1}'
lot 0 pass three.png again.png
says whole/bumps.csv ',pass,'
design 5 '"height_mm":{"min":0.1,"max":1},"radius_mm":{"max":3}'
lot 1 fail gap.png three.png
holds whole/lot.json '"bump 3" in f["defect"] and r["counts"]["rejected"] == 2'
says whole/index.html 'bump 3 is missing'
says whole/bumps.csv 'out_of_tolerance'
valid lot.schema.json whole/lot.json
design 5 '"height_mm":{"min":0.1,"max":1}'
lot 2 fail wide.png gap.png
holds whole/lot.json 'f["verdict"] == "not_measured" and r["quantities"]["overall.radius_mm"]["count"] == 1'

# Tolerances of a bearing: a scan has none, which is said; lots judge their bearings, of three pads here.
design 3 '"circularity_mm":{"max":1}'
expect 0 'not judged here: circularity_mm' "$program" measure three.png -d design.json -o b.json --html b.html
holds b.json 'r["verdict"] == "no_tolerance" and r["not_judged"] == ["circularity_mm"]'
valid measure.schema.json b.json
says b.html 'Not judged here: circularity_mm'
bearings() { # CODE VERDICT LIMITS
  rm -rf whole
  printf '{"schema":"foilgauge/recipe/1","pads":3,"bumps_per_pad":3,"resamples":100,"design":{"schema":"foilgauge/design/1",
"bump_count":3,"calibration":"not needed: the scan is rendered","tolerances":{%s}}}' "$3" >recipe.json
  printf 'scan,bearing\nthree.png,A1\nagain.png,A1\nthird.png,A1\n' >bearings.csv
  cp three.png third.png
  expect "$1" '1 bearing: ' "$program" lot bearings.csv --recipe recipe.json -o whole
  holds whole/lot.json "r['verdict'] == r['bearings'][0]['verdict'] == '$2' and r['bearings'][0]['judgements']"
  valid lot.schema.json whole/lot.json
  says whole/bearings.csv "^A1,.*,$2,9,9,"
}
bearings 0 pass '"circularity_mm":{"max":1},"clearance_centred_min_mm":{"min":-1}'
bearings 1 fail '"clearance_min_mm":{"min":1}'
least=$(python3 -c 'import json; print(json.load(open("whole/lot.json"))["bearings"][0]["min_mm"])')
bearings 3 cannot_tell "\"clearance_min_mm\":{\"min\":$least}"
sed -i '/third/d' bearings.csv
expect 2 '1 not measured' "$program" lot bearings.csv --recipe recipe.json -o whole --resume
holds whole/lot.json 'r["bearings"][0]["verdict"] == "not_measured"'
expect 2 'make none' "$program" lot three.png --recipe recipe.json -o alone
says alone/index.html 'and these foils make none'

exit $failed
