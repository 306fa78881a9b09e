#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The scanner's check measures tone, sharpening and blur: with a driver that changes one of them foils
# get no verdict, until the driver is as it was or the change is accepted; what scatters is no change.
# Usage: test_station_check.sh PROGRAM
name=test_station_check
. "$(dirname "$0")/../support/station.sh"
plain='"blur_px": 1.2'
# plate SEED FILE [SCANNER'S MEMBERS]: laid elsewhere each time
plate() {
  printf '{"schema": "foilgauge/render/1", "seed": %s, "discs": [
    {"centre_mm": [2.%s, 2], "radius_mm": 0.5}, {"centre_mm": [6, 2.%s], "radius_mm": 1},
    {"centre_mm": [2.6, 6.2], "radius_mm": 1.4}],
    "scanner": {"dpi": 2400, "noise": 1.5, %s}}' "$1" "$1" "$1" "${3:-$plain}" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$2"
}
foil() { # SEED FILE
  printf '{"schema": "foilgauge/render/1", "seed": %s, "scanner": {"dpi": 1200},
    "foils": [{"rotate_deg": -90, "design": {"bump_count": 2}}]}' "$1" >"$work/spec.json"
  "$renderer" render "$work/spec.json" -o "$2"
}
# again SQL: the rows of a query
ask() {
  python3 -c 'import sqlite3, sys
for row in sqlite3.connect(sys.argv[1]).execute(sys.argv[2]): print(*row, sep="|")' "$work/in/foilgauge.sqlite" "$1"
}
once() {
  "$program" station "$work/in" --recipe "$work/recipe.json" --once 2>"$work/said" || [ $? -le 3 ] ||
    fail "--once: $(cat "$work/said")"
}
newest() { ask "SELECT $1 FROM checks ORDER BY id DESC LIMIT 1"; }

mkdir "$work/in"
echo '{"schema": "foilgauge/design/1", "form": "discs", "diameters_mm": [1, 2, 2.8]}' >"$work/plate.json"
cat >"$work/recipe.json" <<'R'
{"schema": "foilgauge/recipe/1",
 "station": {"file_name": "{serial}", "check": {"design": "plate.json", "file_name": "check*", "every_h": 24,
   "scale_max_ppm": 500, "withhold": true}},
 "design": {"schema": "foilgauge/design/1", "bump_count": 2,
            "calibration": "not needed: the scan is rendered", "tolerances": {"radius_mm": {"min": 0.1, "max": 90}}}}
R
plate 1 "$work/in/check_1.png"
once
grep -q 'in order.*; the baseline of tone, sharpening and blur' "$work/said" || fail "no baseline: $(cat "$work/said")"
plate 2 "$work/in/check_2.png"
foil 1 "$work/in/A.png"
once
grep -q 'as in the baseline of ' "$work/said" || fail "the plate laid elsewhere: $(cat "$work/said")"
[ "$(newest "changes || baseline")" = 0 ] || fail "a change without any: $(newest changes)"
[ "$(ask "SELECT withheld IS NULL FROM scans WHERE path = 'A.png'")" = 1 ] || fail "withheld without cause"

# changed NAME WORDS SCANNER: a driver that does so is told, and the next foil gets no verdict.
seed=3
changed() {
  plate $seed "$work/in/check_$1.png" "$3"
  foil $seed "$work/in/$1.png"
  once
  grep -q "check_$1.png CHANGED since the baseline of .*$2.*; scanner " "$work/said" ||
    fail "$1 is not told: $(cat "$work/said")"
  [ "$(newest baseline)" = 0 ] || fail "$1 is a baseline"
  foil "1$seed" "$work/in/after_$1.png"
  once
  ask "SELECT withheld FROM scans WHERE path = 'after_$1.png'" | grep -q 'another tone, sharpening or blur' ||
    fail "$1: not withheld: $(ask "SELECT path, withheld FROM scans")"
  seed=$((seed + 1))
}
changed sharpened 'sharpened' "$plain, \"unsharp_mask\": {\"amount_pct\": 100, \"radius_px\": 1}"
changed brighter 'tone_curve\|edges of bright parts' "$plain, \"tone_curve\": [[0, 0], [128, 160], [255, 255]]"
changed contrast 'tone_curve\|edges of bright parts' \
  "$plain, \"tone_curve\": [[0, 0], [64, 30], [128, 128], [192, 226], [255, 255]]"
changed unsharp 'blur' '"blur_px": 1.7'
changed darker gamma "$plain, \"gamma\": 1.8"

# As it was: foils get their verdicts again.
plate 18 "$work/in/check_good.png"
once
foil 18 "$work/in/B.png"
once
[ "$(ask "SELECT withheld IS NULL FROM scans WHERE path = 'B.png'")" = 1 ] || fail "withheld after a good check"

# A change that is meant is accepted on the page, once, and later checks are held against it.
plate 19 "$work/in/check_new.png" "$plain, \"gamma\": 1.8"
"$program" station "$work/in" --recipe "$work/recipe.json" --port 0 >"$work/address" 2>"$work/err" &
station=$!
checks - "$work" <<'P' || fail "accepting: $(cat "$work/err")"
import re, sys, time, urllib.error, urllib.parse, urllib.request
base = wait_until(lambda: open(sys.argv[1] + "/address").read().strip())
page = lambda: plain(urllib.request.urlopen(base + "scanner").read().decode())
# An earlier check is in the page's history as CHANGED: only the newest one can be accepted.
wait_until(lambda: 'name="form"' in page())
text = page()
assert "CHANGED" in text
now = plain(urllib.request.urlopen(base).read().decode())
assert ">CHECK FAILED<" in now and "Do not go on with foils" in now and "Go on with foils." not in now, now
with open(sys.argv[1] + "/changed.html", "w") as file:
    file.write(urllib.request.urlopen(base + "scanner").read().decode() + urllib.request.urlopen(base).read().decode())
token = re.search(r'name="form" value="(\w+)"', text).group(1)
check = re.search(r'name="id" value="(\d+)"', text).group(1)
def post(fields):
    try:
        return urllib.request.urlopen(base + "baseline", urllib.parse.urlencode(fields).encode()).status
    except urllib.error.HTTPError as error:
        return error.code
assert post({"id": check}) == 403, "without the page's token"
assert "CHANGED" in page()
assert post({"form": token, "id": str(int(check) - 1)}) == 404
assert post({"form": token, "id": check}) == 200
text = page()
with open(sys.argv[1] + "/scanner.html", "w") as file:
    file.write(urllib.request.urlopen(base + "scanner").read().decode())
assert "IN ORDER" in text and "This check is the baseline" in text and "as the new baseline" not in text, text
P
kill "$station"
wait "$station" 2>/dev/null || true
station=
said=$("$(dirname "$program")/tests/missing_words" de "$work/scanner.html" "$work/changed.html") || fail "no German words: $said"
plate 12 "$work/in/check_like_it.png" "$plain, \"gamma\": 1.8"
once
[ "$(newest changes)" = "" ] || fail "as accepted, and a change: $(newest changes)"
plate 13 "$work/in/check_as_at_first.png"
once
[ "$(newest changes)" != "" ] || fail "no change against what was accepted"

# Another resolution has a baseline of its own; the states of a database of version 2 are not known.
sed 's/2400/1200/' "$work/spec.json" >"$work/coarse.json"
"$renderer" render "$work/coarse.json" -o "$work/in/check_1200.png"
once
[ "$(newest "baseline || changes")" = 1 ] || fail "at 1200 dpi: $(newest "baseline, changes")"
python3 tests/support/older_database.py "$work/in/foilgauge.sqlite" 2
count=$(ask "SELECT count(*) FROM checks")
plate 14 "$work/in/check_migrated.png" "$plain, \"gamma\": 1.8"
once
[ "$(newest "baseline || changes")" = 1 ] || fail "after a migration: $(newest "baseline, changes")"
[ "$(ask "SELECT count(*) FROM checks WHERE dpi IS NULL")" = "$count" ] || fail "checks of version 2 are gone"
