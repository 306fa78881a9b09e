#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The state of a picture in every form of the report: findings are named with their cure, and a plain scan is told apart.
if ! command -v python3 >/dev/null; then
  echo "skipped: no python3"
  exit 77
fi
. tests/support/cli.sh

render() { # NAME SCANNER
  echo "{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"foils\":[{\"design\":{\"bump_count\":2}}],\"scanner\":{\"dpi\":2400,
    \"blur_px\":1,\"noise\":1.5,\"background\":30,\"contrast\":160$2}}" >spec.json
  "$renderer" render spec.json -o "$1.png" || fail "render $1"
  "$program" measure "$1.png" -o "$1.json" --html "$1.html" --csv "$1.csv" 2>"$1.note"
}

render plain ''
render sharp ',"unsharp_mask":{"amount_pct":100,"radius_px":1}'
render blocks ',"rough":{"jpeg":{"quality":75}}'

checks - <<'P' || fail "the reports' findings"
import json
def read(name):
    report = json.load(open(name + ".json"))
    return report["picture"], report["foils"][0]["flags"]
picture, flags = read("plain")
assert picture["findings"] == [], picture["findings"]
assert picture["gray_levels"] > 100 and abs(picture["blur_max_px"] - 1.05) < 0.1
picture, flags = read("sharp")
assert [f["finding"] for f in picture["findings"]].count("sharpened") == 1 and "sharpened" in flags
assert picture["overshoot"] > 0.01 and picture["undershoot"] > 0.01
assert all(f["meaning"] and f["cure"] for f in picture["findings"])
picture, flags = read("blocks")
assert "block_noise" in flags and picture["block_noise"] > 0.2, picture
P
grep -q 'state of the picture: .*sharpened' sharp.note || fail "no note"
grep -q 'picture' plain.note && fail "a note of a plain scan"
grep -q 'sharpened' sharp.csv || fail "no flag in the CSV"
grep -q '<h2>State of the picture</h2>' sharp.html || fail "no section on the page"
exit 0
