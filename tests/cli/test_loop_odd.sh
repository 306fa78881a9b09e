#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop on scans without a foil of the design: it says so, the foils beside it still count, nothing ends with a signal.
. tests/support/loop.sh
skip_when_slow

# Three times as large as the design has it, and no thicker.
cat >large.json <<'SPEC'
{"schema":"foilgauge/render/1","seed":3,
 "foils":[{"design":{"bump_count":3},"overall_radius_mm":62,"radius_mm":[3.4,3.4,3.4]}],
 "scanner":{"dpi":2400,"background":30,"contrast":175,"blur_px":1.3,"noise":1.2}}
SPEC
sed 's/"overall_radius_mm":62/"overall_radius_mm":20.9/' large.json >fits.json
for name in large fits; do "$renderer" render $name.json -o $name.png || fail "render $name"; done
expect 2 "large.png: .* no foil of the design .* overall radius" "$program" loop large.png -o never.json
[ ! -e never.json ] || fail "a report is left of what was not measured"

# Beside a foil of the design it takes no part, and the report says so.
"$program" loop large.png fits.png -o both.out
[ $? -eq 2 ] || fail "a foil was left out, and the exit code is not 2"
valid loop_scan.schema.json both.out
python3 - <<'E2' || failed=1
import json, sys
report = json.load(open("both.out"))
foils = report["before"]["foils"]
ok = (any("foil 1 is left out" in note for note in report["notes"]) and "not_measured" in foils[0]["flags"]
      and "not_measured" not in foils[1]["flags"])
sys.exit(0 if ok else "the report does not say which foil was left out")
E2

knife=${FOILGAUGE_SHARED:-$root/../shared}/real/knife_scale_1200dpi.png
if [ -e "$knife" ]; then
  for form in classical sinusoidal; do expect 2 "no foil of the design" "$program" loop "$knife" --dpi 1200 --form $form; done
fi

exit $failed
