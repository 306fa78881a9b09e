/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Specs of the renderer that must be refused, each by the member that is wrong. */
#include <stdio.h>
#include <string.h>

#include "foilgauge/render.h"
#include "support/test.h"

typedef struct bad_spec {
  const char *json, *words;
} bad_spec;

#define HEAD "{\"schema\":\"foilgauge/render/1\","

#define SCANNER(members)     HEAD "\"scanner\":{" members "}}"
#define ROUGH(members)       HEAD "\"scanner\":{\"rough\":{" members "}}}"
#define JUMPS(name, members) HEAD "\"scanner\":{\"" name "\":" members "}}"
#define LIFT(members)        HEAD "\"effects\":[{\"id\":\"free.bump.index\"" members "}]}"
#define CURVE(id, members)   HEAD "\"effects\":[{\"id\":\"free." id "\"," members "}]}"

static void too_many_knots_are_refused(void **state) {
  (void)state;
  for (int count = 64; count <= 65; count++) {
    char json[2048] = HEAD "\"effects\":[{\"id\":\"free.scan.y\",\"knots\":[";
    for (int i = 0; i < count; i++)
      snprintf(json + strlen(json), sizeof json - strlen(json), "%s[%d,1]", i ? "," : "", i);
    strcat(json, "]}]}");
    fg_context ctx = {0};
    fg_render_spec *spec = NULL;
    assert_int_equal(fg_render_parse(&ctx, "spec.json", json, &spec),
                     count == 64 ? FG_OK : FG_ERR_DATA);
    if (count > 64) assert_has(ctx.message, "2 to 64 knots");
    fg_render_free(spec);
  }
}

static void bad_specs_are_refused_by_name(void **state) {
  (void)state;
  static const bad_spec table[] = {
      {"", "this is not JSON"},
      {"{\"schema\":", "this is not JSON"},
      {"[]", "the spec is []: must be an object"},
      {"{}", "schema is missing: must be \"foilgauge/render/1\""},
      {"{\"schema\":\"foilgauge/design/1\"}", "schema is \"foilgauge/design/1\""},
      {HEAD "\"sede\":1}", "sede is 1: there is no such member; there are width_px, "},
      {HEAD "\"seed\":-1}", "seed is -1: must be a number from 0"},
      {HEAD "\"seed\":1,\"seed\":2}", "seed is 2: given twice"},
      {HEAD "\"width_px\":4}", "width_px is 4: must be a number from 16 to 200000"},
      {HEAD "\"width_px\":100.5}", "width_px is 100.5: must be a whole number"},
      {HEAD "\"foils\":3}", "foils is 3: must be an array"},
      {HEAD "\"foils\":[3]}", "foils[0] is 3: must be an object"},
      {HEAD "\"foils\":[{\"overall_radius_mm\":-20}]}", "foils[0].overall_radius_mm is -20"},
      {HEAD "\"foils\":[{\"design\":{\"bump_radius_mm\":\"3\"}}]}",
       "foils[0].design.bump_radius_mm is \"3\": must be a number"},
      {HEAD "\"foils\":[{\"design\":{\"bump_count\":2.5}}]}", "must be a whole number"},
      {HEAD "\"foils\":[{\"radius_mm\":[3.3]}]}", "foils[0].radius_mm is [3.3]: must be an array"},
      {HEAD "\"foils\":[{\"missing\":[10]}]}",
       "foils[0].missing[0] is 10: must be a number from 1"},
      {HEAD "\"foils\":[{\"crushed\":[{\"height_factor\":0.5}]}]}", "crushed[0].bump is missing"},
      {HEAD "\"foils\":[{\"lip\":{\"side\":\"up\"}}]}", "foils[0].lip.side is \"up\""},
      {HEAD "\"foils\":[{\"mirror\":1}]}", "foils[0].mirror is 1: must be true or false"},
      {HEAD "\"foils\":[{\"design\":{\"fillet_radius_mm\":90}}]}",
       "cannot meet the overall circle"},
      {HEAD "\"foils\":[{\"design\":{\"pitch_deg\":5}}]}", "overlaps the one before it"},
      {HEAD "\"foils\":[{\"design\":{\"pitch_deg\":45}}]}", "longer than a full turn"},
      {HEAD "\"discs\":[{\"radius_mm\":1}]}", "discs[0].centre_mm is missing"},
      {HEAD "\"discs\":[{\"centre_mm\":[1,1]}]}", "discs[0].radius_mm is missing"},
      {HEAD "\"scanner\":{\"bits\":12}}", "scanner.bits is 12: must be 8 or 16"},
      {HEAD "\"scanner\":{\"dpi\":0}}", "scanner.dpi is 0: must be a number from 50"},
      {HEAD "\"scanner\":{\"dpi\":[4800]}}", "scanner.dpi is [4800]: must be an array of 2"},
      {HEAD "\"scanner\":{\"blur_px\":0.1}}", "scanner.blur_px is 0.1: must be a number from 0.4"},
      {HEAD "\"scanner\":{\"background\":200,\"contrast\":100}}", "scanner.contrast is 100"},
      {HEAD "\"scanner\":{\"bits\":16,\"rough\":{\"jpeg\":{\"quality\":90}}}}", "must be 8 where"},
      {HEAD "\"scanner\":{\"rough\":{\"halo\":{\"fraction\":2}}}}",
       "scanner.rough.halo.fraction is 2"},
      {HEAD "\"scanner\":{\"blur_px\":[1,2,3]}}", "scanner.blur_px is [1,2,3]: must be an array"},
      {HEAD "\"scanner\":{\"blur_px\":[1,0.2]}}", "scanner.blur_px[1] is 0.2: must be a number"},
      {HEAD "\"scanner\":{\"blur_px\":\"soft\"}}", "scanner.blur_px is \"soft\""},
      {HEAD "\"scanner\":{\"dpi\":[4800,1200]}}", "at least 1.6 along x at these resolutions"},
      {ROUGH("\"motion_blur_px\":-1"), "scanner.rough.motion_blur_px is -1: must be a number"},
      {ROUGH("\"motion_blur_px\":NaN"), "this is not JSON"},
      {ROUGH("\"one_sided_way\":\"x\""), "one_sided_way is \"x\": must be \"+y\" or \"-y\""},
      {ROUGH("\"correlation_um\":0.1"), "correlation_um is 0.1: must be a number from 0.2 to"},
      {ROUGH("\"correlation_form\":2"), "must be \"gaussian\" or \"exponential\""},
      {JUMPS("rows_lost", "3"), "scanner.rows_lost is 3: must be an array of at most 64"},
      {JUMPS("rows_lost", "[3]"), "scanner.rows_lost[0] is 3: must be an object"},
      {JUMPS("rows_lost", "[{\"count\":3}]"), "scanner.rows_lost[0].y_mm is missing"},
      {JUMPS("rows_lost", "[{\"y_mm\":1}]"), "scanner.rows_lost[0].count is missing"},
      {JUMPS("rows_lost", "[{\"y_mm\":1,\"count\":0}]"), "rows_lost[0].count is 0: say how many"},
      {JUMPS("rows_lost", "[{\"y_mm\":1,\"count\":1.5}]"), "count is 1.5: must be a whole number"},
      {JUMPS("rows_lost", "[{\"y_mm\":1,\"count\":2000}]"), "count is 2000: must be a number"},
      {JUMPS("rows_lost", "[{\"y_mm\":900,\"count\":1}]"),
       "scanner.rows_lost[0] is at 900 mm: must be within the picture's"},
      {JUMPS("stitches", "[{\"rows\":3}]"), "scanner.stitches[0].y_mm is missing"},
      {JUMPS("stitches", "[{\"y_mm\":1}]"),
       "scanner.stitches[0].rows is missing: say how many rows"},
      {JUMPS("stitches", "[{\"y_mm\":1,\"rows\":0.5}]"), "rows is 0.5: must be a whole number"},
      {JUMPS("stitches", "[{\"y_mm\":900,\"rows\":1}]"),
       "scanner.stitches[0] is at 900 mm: must be within the picture's"},
      {JUMPS("chip_seams", "{}"), "scanner.chip_seams is {}: must be an array"},
      {JUMPS("chip_seams", "[{\"shift_um\":3}]"), "scanner.chip_seams[0].x_mm is missing"},
      {JUMPS("chip_seams", "[{\"x_mm\":1}]"), "chip_seams[0].shift_um is missing: say by how much"},
      {JUMPS("chip_seams", "[{\"x_mm\":1,\"shift_um\":1e999}]"), "chip_seams[0].shift_um is"},
      {JUMPS("chip_seams", "[{\"x_mm\":1,\"shift\":3}]"), "shift is 3: there is no such member"},
      {JUMPS("chip_seams", "[{\"x_mm\":900,\"shift_um\":3}]"),
       "scanner.chip_seams[0] is at 900 mm: must be within the picture's"},
      {SCANNER("\"blur_angle_deg\":200"),
       "scanner.blur_angle_deg is 200: must be a number from -180"},
      {SCANNER("\"blur_angle_deg\":[30]"), "scanner.blur_angle_deg is [30]: must be a number"},
      {SCANNER("\"dpi\":[2400,1200],\"blur_px\":[1,0.7],\"blur_angle_deg\":30"),
       "at least 0.8 along both axes at these resolutions"},
      {SCANNER("\"resampled_from_dpi\":20"),
       "scanner.resampled_from_dpi is 20: must be a number from"},
      {SCANNER("\"resampled_from_dpi\":9600"), "resampled_from_dpi is 9600: must be at most dpi"},
      {SCANNER("\"resampled_from_dpi\":[2400]"),
       "resampled_from_dpi is [2400]: must be an array of 2"},
      {SCANNER("\"resampled_from_dpi\":2400,\"resampled_by\":\"lanczos\""),
       "resampled_by is \"lanczos\": must be \"bilinear\" or \"bicubic\""},
      {SCANNER("\"resampled_by\":\"bicubic\""), "belongs to resampled_from_dpi"},
      {SCANNER("\"shadow\":-0.3"), "scanner.shadow is -0.3: must be an object"},
      {SCANNER("\"shadow\":{\"width_deg\":30}"),
       "scanner.shadow.amplitude is missing: say how much"},
      {SCANNER("\"shadow\":{\"amplitude\":-2}"),
       "scanner.shadow.amplitude is -2: must be a number"},
      {SCANNER("\"shadow\":{\"amplitude\":1,\"width_deg\":0}"), "width_deg is 0: must be a number"},
      {SCANNER("\"shadow\":{\"amplitude\":1,\"length_px\":0}"), "length_px is 0: must be a number"},
      {SCANNER("\"tone_curve\":3"), "scanner.tone_curve is 3: must be an array of 2 to 256 points"},
      {SCANNER("\"tone_curve\":[[0,0]]"), "must be an array of 2 to 256 points"},
      {SCANNER("\"tone_curve\":[[0,0],[9]]"), "scanner.tone_curve[1] is [9]: must be [in, out]"},
      {SCANNER("\"tone_curve\":[[0,0],[9,null]]"), "tone_curve[1].out is null: must be a number"},
      {SCANNER("\"tone_curve\":[[0,0],[300,9]]"), "tone_curve[1].in is 300: must be a number from"},
      {SCANNER("\"tone_curve\":[[0,0],[0,9]]"), "in must ascend and out must not fall"},
      {SCANNER("\"tone_curve\":[[0,20],[9,10]]"), "and the one before is [0, 20]"},
      {SCANNER("\"tone_bits\":8"), "scanner.tone_bits is 8: belongs to tone_curve"},
      {SCANNER("\"tone_curve\":[[0,0],[9,9]],\"tone_bits\":7"), "tone_bits is 7: must be a number"},
      {SCANNER("\"unsharp_mask\":150"), "scanner.unsharp_mask is 150: must be an object"},
      {SCANNER("\"unsharp_mask\":{}"), "scanner.unsharp_mask.amount_pct is missing: say how much"},
      {SCANNER("\"unsharp_mask\":{\"amount_pct\":-5}"),
       "amount_pct is -5: must be a number from 0"},
      {SCANNER("\"unsharp_mask\":{\"amount_pct\":5,\"radius_px\":0}"), "radius_px is 0: must be"},
      {SCANNER("\"unsharp_mask\":{\"amount_pct\":5,\"threshold\":256}"), "threshold is 256: must"},
      {SCANNER("\"unsharp_mask\":{\"amount\":5}"), "amount is 5: there is no such member"},
      {SCANNER("\"levels\":1"), "scanner.levels is 1: must be a number from 2 to 256"},
      {SCANNER("\"levels\":257"), "scanner.levels is 257: must be a number from 2 to 256"},
      {SCANNER("\"levels\":2.5"), "scanner.levels is 2.5: must be a whole number"},
      {SCANNER("\"bits\":16,\"levels\":65537"), "scanner.levels is 65537: must be a number"},
      {SCANNER("\"threshold\":100"), "scanner.threshold is 100: belongs to two levels"},
      {SCANNER("\"levels\":4,\"threshold\":100"), "threshold is 100: belongs to two levels"},
      {SCANNER("\"levels\":2,\"threshold\":-1"), "scanner.threshold is -1: must be a number"},
      {HEAD "\"effects\":[{\"id\":\"part.ovality\",\"amplitude_um\":5,\"angle_deg\":30}]}",
       "angle_deg is 30: there is no such member; there are id, amplitude_um, phase_deg, along"},
      {HEAD "\"effects\":[{\"id\":\"scan.magic\"}]}", "effects[0].id is \"scan.magic\""},
      {HEAD "\"effects\":[{\"id\":\"scan.scale_y\"}]}", "effects[0].value is missing"},
      {HEAD "\"effects\":[{\"id\":\"scan.scale_y\",\"value\":0.001,\"x\":1}]}",
       "effects[0].x is 1"},
      {HEAD "\"effects\":[{\"id\":\"free.scan.x\"}]}", "effects[0].knots is missing"},
      {CURVE("scan.x", "\"knots\":[[1,2]]"), "effects[0].knots is [[1,2]]: must be an array of 2"},
      {CURVE("scan.x", "\"knots\":[[1,2],[3]]"), "knots[1] is [3]: must be [mm, um]"},
      {CURVE("scan.x", "\"knots\":[[1,2],[1,3]]"), "ascend, and the one before is at 1"},
      {CURVE("scan.x", "\"knots\":[[1,2],[3,NaN]]"), "this is not JSON"},
      {CURVE("scan.x", "\"knots\":[[1,2],[3,null]]"), "knots[1].um is null: must be a number"},
      {CURVE("scan.x", "\"knots\":[[1,2],[3,1e999]]"), "knots[1].um is"},
      {CURVE("scan.x", "\"knots\":[[1,2],[1.1,50]]"), "at most 100"},
      {CURVE("scan.x", "\"moves\":\"z\",\"knots\":[[1,2],[3,4]]"), "moves is \"z\": must be \"x\""},
      {CURVE("foil.s", "\"moves\":\"x\",\"knots\":[[0,2],[1,4]]"), "moves is \"x\": there is no"},
      {CURVE("foil.s", "\"knots\":[[0,2],[1.5,4]]"), "knots[1].u is 1.5: must be a number from -1"},
      {CURVE("edge.normal", "\"edges\":1,\"knots\":[[0,2],[1,4]]"), "edges is 1: must be"},
      {CURVE("edge.normal", "\"knots\":[[0,2],[360,2]]"), "0 and 360 are one direction"},
      {LIFT(""), "say which bumps, one way: bumps, every, period_bumps or values_um"},
      {LIFT(",\"amplitude_um\":4"), "say which bumps, one way"},
      {LIFT(",\"amplitude_um\":4,\"every\":3,\"bumps\":[2]"), "say which bumps, one way"},
      {LIFT(",\"every\":3"), "effects[0].amplitude_um is missing: bumps, every and"},
      {LIFT(",\"amplitude_um\":1,\"values_um\":[1,2]"), "effects[0].amplitude_um is 1: bumps"},
      {LIFT(",\"amplitude_um\":4,\"every\":0"), "effects[0].every is 0: must be a number from 1"},
      {LIFT(",\"amplitude_um\":4,\"every\":2.5"),
       "effects[0].every is 2.5: must be a whole number"},
      {LIFT(",\"amplitude_um\":4,\"bumps\":[2],\"first\":1"), "first is 1: belongs to every"},
      {LIFT(",\"amplitude_um\":4,\"every\":2,\"phase_deg\":1"), "belongs to period_bumps"},
      {LIFT(",\"amplitude_um\":4,\"period_bumps\":1"),
       "period_bumps is 1: must be a number from 1.5"},
      {LIFT(",\"amplitude_um\":99,\"every\":3"), "effects[0].amplitude_um is 99: must be a number"},
      {LIFT(",\"amplitude_um\":4,\"bumps\":[]"), "effects[0].bumps is []: must be an array of 1"},
      {LIFT(",\"amplitude_um\":4,\"bumps\":[1.5]"), "effects[0].bumps is [1.5]: must be whole"},
      {LIFT(",\"amplitude_um\":4,\"bumps\":[12]"), "effects[0] raises bump 12: no foil has so"},
      {LIFT(",\"values_um\":[1,null]"), "effects[0].values_um[1] is null: must be a number"},
      {LIFT(",\"values_um\":[1],\"form\":\"half\""), "must be \"crown\" or \"whole\""},
      {HEAD "\"effects\":[{\"id\":\"part.stretch\"}]}", "effects[0].value_rel is missing"},
  };
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    in_row("table[%zu]", i);
    fg_context ctx = {0};
    fg_render_spec *spec = (fg_render_spec *)table;
    if (fg_render_parse(&ctx, "spec.json", table[i].json, &spec) != FG_ERR_DATA)
      fail_msg("not refused: %s", table[i].json);
    assert_null(spec);
    if (!strstr(ctx.message, table[i].words) || strncmp(ctx.message, "spec.json: ", 11) != 0)
      fail_msg("'%s' does not say '%s'", ctx.message, table[i].words);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(too_many_knots_are_refused),
      cmocka_unit_test(bad_specs_are_refused_by_name),
  };
  return cmocka_run_group_tests_name("render specs", tests, NULL, NULL);
}
