#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Beams of a second renderer: square ends of slits of a few pixels, and long edges that lie nearly along the pixels, where a few of them
# imitate an unsharp mask.
. tests/support/cli.sh
listened="stdout stderr"
/usr/bin/python3 -c "import numpy, scipy" 2>/dev/null || { echo "skipped: no numpy and scipy"; exit 77; }

# draw NAME DPI KERF_PX TURN NOISE SQUARE: three beams, whose lengths it keeps.
draw() {
  PYTHONPATH="$root/tests/bench" /usr/bin/python3 - "$@" <<'END' || fail "draw $1"
import json, sys
import numpy as np
import other_beams
name, (dpi, kerf_px, turn, noise, square) = sys.argv[1], map(float, sys.argv[2:])
sizes = [(2.82, 0.80, 0.80), (2.75, 0.84, 0.84), (2.73, 0.83, 0.83)]
outlines = other_beams.sheet(sizes, 1.62, kerf_px * 25.4 / dpi, 1.0, 0, not square)
other_beams.write_png(name + ".png", other_beams.render(outlines, np.random.default_rng(5), dpi, turn, 1.2, noise, True, 16), dpi)
json.dump([length for length, *_ in sizes], open(name + ".truth", "w"))
END
}
echo '{"schema": "foilgauge/design/1", "form": "cantilever", "beam_count": 3, "beam_length_mm": 2.8, "beam_width_mm": 0.82, "thickness_mm": 0.1}' >design.json
# within NAME UM: lengths, and of U.
within() {
  expect 0 "" "$program" measure "$1.png" --design design.json -o "$1.json"
  checks - "$1" "$2" <<'END' || fail "lengths of $1"
import json, sys
truth, beams = json.load(open(sys.argv[1] + ".truth")), json.load(open(sys.argv[1] + ".json"))["foils"][0]["beams"]
errors = [1000 * (b["length_mm"] - t) for b, t in zip(beams, truth)]
assert len(errors) == 3 and all(abs(e) < float(sys.argv[2]) for e in errors), errors
assert all(abs(e) < 3000 * b["u_length_mm"] for e, b in zip(errors, beams)), errors
END
}
draw along 4800 23.6 175.56 0.1 0 && within along 0.1
draw square 1200 7 33 0.3 1 && within square 0.5
draw narrow 1200 5 33 0.3 1
expect 2 "narrow_cut" "$program" measure narrow.png --design design.json
"$program" measure narrow.png --design design.json -o narrow.json 2>/dev/null
[ "$(value narrow.json '[b["length_mm"] for b in r["foils"][0]["beams"]]')" = "[None, None, None]" ] || fail "a cut of 5 px has a length"
exit $failed
