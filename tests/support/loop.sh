# What the scripts that render and measure share; sourced with the program's path. Works in a folder of its own;
# `root` is the checkout. A script ends with `exit $failed`.
set -u
program=$(realpath "$1")
# Draws what the tests look at: a build that is not slowed down by sanitizers, where there is one.
renderer=${FOILGAUGE_RENDERER-}
[ -x "$renderer" ] || renderer=$program
root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0

fail() {
  echo "FAIL: $*"
  failed=1
}

# value FILE EXPRESSION: a number or word out of a report.
value() {
  python3 -c "import json,sys; r=json.load(open(sys.argv[1])); print(eval(sys.argv[2]))" "$1" "$2"
}

# near NAME VALUE EXPECTED TOLERANCE
near() {
  python3 -c "import sys; sys.exit(not abs(float(sys.argv[1]) - float(sys.argv[2])) <= float(sys.argv[3]))" \
    "$2" "$3" "$4" || fail "$1 is $2, not $3 within $4"
}

# render_foil NAME SEED ROTATION EFFECTS DPI [MEMBERS OF THE SPEC] [MEMBERS OF THE FOIL], each with a comma behind it
render_foil() {
  cat >"$1.json" <<SPEC
{"schema":"foilgauge/render/1","seed":$2,${6-}
 "foils":[{"overall_radius_mm":20.95,"radius_mm":[3.34,3.41,3.36,3.44,3.38,3.35,3.42,3.37,3.40],
           ${7-}"rotate_deg":$3}],
 "scanner":{"dpi":$5,"background":30,"contrast":175,"blur_px":1.3,"noise":1.2},
 "effects":[$4]}
SPEC
  "$renderer" render "$1.json" -o "$1.png" --truth "$1.truth.json" || fail "render $1"
}

# valid SCHEMA FILE...: the files keep to a schema of reports/schema, where python3-jsonschema can tell.
valid() {
  local code=0
  python3 "$root/tests/support/validate_schema.py" "$root/reports/schema" "$@" || code=$?
  [ $code -eq 0 ] || [ $code -eq 77 ] || fail "$* does not validate"
}
