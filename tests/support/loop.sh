# SPDX-License-Identifier: GPL-3.0-or-later
# Shared functions, beside cli.sh, of the scripts that render and measure; sourced with the program's path.
. "${BASH_SOURCE[0]%/*}/cli.sh"

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
