/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dimensions of dies: of a design, and from reports of dies that were measured or are to be cut. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compensation/sets.h"
#include "core/file.h"
#include "core/json_read.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/words.h"

enum { DIE_REPORT_BYTES = 64 << 20 };

static const double degrees = 57.29577951308232; /* of a radian */

fg_status fg_die_dimensions_of_design(fg_context *ctx, const fg_design *design, size_t bumps,
                                      fg_die_dimensions *die) {
  *die = (fg_die_dimensions){.overall_radius_mm = design->overall_radius_mm};
  if (!fg_foil_traits_of(design->kind)->has_bumps) return FG_OK;
  if (bumps > FG_COMPENSATION_BUMPS)
    return fg_fail(ctx, FG_ERR_DATA, "%zu bumps: a die is found for %d at most", bumps,
                   FG_COMPENSATION_BUMPS);
  die->pitch_deg = design->bumps.pitch_deg;
  die->fillet_radius_mm = design->bumps.fillet_radius_mm;
  die->bumps = bumps;
  for (size_t i = 0; i < bumps; i++)
    die->bump[i] = (fg_die_bump_dimensions){.number = (int)i + 1,
                                            .radius_mm = design->bumps.radius_mm,
                                            .bump_angle_deg = design->bumps.angle_deg};
  return fg_die_dimensions_derive(ctx, design, die);
}

/* A die is held to the rules of a design: its circles meet, its bumps do not overlap. */
static fg_status derive_bump(fg_context *ctx, const fg_design *design, fg_die_dimensions *die,
                             fg_die_bump_dimensions *bump) {
  fg_design made = *design;
  fg_nominal nominal;
  fg_context inner = {.message = ""};
  made.overall_radius_mm = made.bumps.sleeve_radius_mm = die->overall_radius_mm;
  made.bumps.radius_mm = bump->radius_mm;
  made.bumps.angle_deg = bump->bump_angle_deg;
  made.bumps.pitch_deg = die->pitch_deg;
  made.bumps.fillet_radius_mm = die->fillet_radius_mm;
  if (fg_design_derive(&inner, &made, &nominal) != FG_OK)
    return fg_fail(ctx, FG_ERR_DATA, "bump %d of the die: %s", bump->number, inner.message);
  double height = nominal.height_mm, r0 = die->overall_radius_mm, r = bump->radius_mm;
  double half = bump->bump_angle_deg / degrees / 2, x = nominal.centre_to_centre_mm;
  /* h = R0 - X + R and R0² = X² + R² - 2 X R cos(alpha / 2): its derivatives by the three. */
  double by_x = x - r * cos(half), dx_r0 = r0 / by_x;
  double dx_r = -(r - x * cos(half)) / by_x, dx_half = -x * r * sin(half) / by_x;
  double u_half = bump->u_bump_angle_deg / degrees / 2;
  bump->height_mm = height;
  bump->u_height_mm = sqrt(pow((1 - dx_r0) * die->u_overall_radius_mm, 2) +
                           pow((1 - dx_r) * bump->u_radius_mm, 2) + pow(dx_half * u_half, 2));
  return FG_OK;
}

fg_status fg_die_dimensions_derive(fg_context *ctx, const fg_design *design,
                                   fg_die_dimensions *die) {
  for (size_t i = 0; i < die->bumps; i++) {
    fg_die_bump_dimensions *bump = &die->bump[i];
    double from_middle = (double)i - 0.5 * (double)(die->bumps - 1);
    bump->place_deg = from_middle * die->pitch_deg;
    bump->u_place_deg = fabs(from_middle) * die->u_pitch_deg;
    FG_TRY(derive_bump(ctx, design, die, bump));
  }
  return FG_OK;
}

static double read_number_or(const cJSON *object, const char *name, double otherwise) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  return cJSON_IsNumber(item) ? item->valuedouble : otherwise;
}

/* Lengths belong to a datum line, and of a strip to its thickness: other ones are other dies. */
static fg_status check_die_design(fg_context *ctx, const cJSON *of, const fg_design *design) {
  const cJSON *datum = cJSON_GetObjectItemCaseSensitive(of, "datum");
  double thickness = read_number_or(of, "thickness_mm", NAN);
  if (cJSON_IsString(datum) && strcmp(datum->valuestring, fg_datum_word(design->datum)) != 0)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "the die's datum is %s, the target's is %s: measure the die with the target's design",
        datum->valuestring, fg_datum_word(design->datum));
  if (!(fabs(thickness - design->thickness_mm) < 1e-9))
    return fg_fail(ctx, FG_ERR_DATA,
                   "the die is of a strip of %g mm, the target has %g mm: measure the die with the "
                   "target's design",
                   thickness, design->thickness_mm);
  return FG_OK;
}

static bool is_size(double value) {
  return value > 0 && value < 1e4;
}

/* Reads the bumps that a report has, in place of the design's or of the die's mean. */
static fg_status read_die_bumps(fg_context *ctx, const cJSON *list, fg_die_dimensions *die) {
  const cJSON *item;
  cJSON_ArrayForEach(item, list) {
    size_t i = (size_t)(read_number_or(item, "number", 0) - 1);
    if (i >= die->bumps) continue;
    fg_die_bump_dimensions *bump = &die->bump[i];
    bump->radius_mm = read_number_or(item, "radius_mm", NAN);
    bump->bump_angle_deg = read_number_or(item, "bump_angle_deg", NAN);
    bump->u_radius_mm = read_number_or(item, "u_radius_mm", 0);
    bump->u_bump_angle_deg = read_number_or(item, "u_bump_angle_deg", 0);
    if (!is_size(bump->radius_mm) || !is_size(bump->bump_angle_deg))
      return fg_fail(ctx, FG_ERR_DATA, "bump %d has no radius and angle", bump->number);
  }
  return FG_OK;
}

/* The slope of the places' errors over the bumps' numbers is an error of the pitch. */
static double pitch_error(const cJSON *list) {
  const cJSON *item;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  cJSON_ArrayForEach(item, list) {
    double number = read_number_or(item, "number", NAN);
    double place = read_number_or(item, "place_error_deg", NAN);
    if (!isfinite(number) || !isfinite(place)) continue;
    n++;
    x += number;
    y += place;
    xx += number * number;
    xy += number * place;
  }
  return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
}

static fg_status read_measured_die(fg_context *ctx, const cJSON *root, fg_die_dimensions *die) {
  const cJSON *whole = cJSON_GetObjectItemCaseSensitive(root, "die");
  const cJSON *mean = cJSON_GetObjectItemCaseSensitive(whole, "mean");
  const cJSON *overall = cJSON_GetObjectItemCaseSensitive(whole, "overall");
  const cJSON *bumps = cJSON_GetObjectItemCaseSensitive(whole, "bumps");
  for (size_t i = 0; i < die->bumps; i++) {
    die->bump[i].radius_mm = read_number_or(mean, "radius_mm", die->bump[i].radius_mm);
    die->bump[i].bump_angle_deg = read_number_or(mean, "bump_angle_deg", NAN);
  }
  die->overall_radius_mm = read_number_or(overall, "radius_mm", NAN);
  die->u_overall_radius_mm = read_number_or(overall, "u_radius_mm", 0);
  die->pitch_deg += pitch_error(bumps);
  return read_die_bumps(ctx, bumps, die);
}

static fg_status read_die_to_cut(fg_context *ctx, const cJSON *root, fg_die_dimensions *die) {
  const cJSON *own = cJSON_GetObjectItemCaseSensitive(root, "die");
  die->overall_radius_mm = read_number_or(own, "overall_radius_mm", NAN);
  die->pitch_deg = read_number_or(own, "pitch_deg", die->pitch_deg);
  return read_die_bumps(ctx, cJSON_GetObjectItemCaseSensitive(own, "bumps"), die);
}

static fg_status read_die_report(fg_context *ctx, const cJSON *root, const fg_design *design,
                                 fg_die_dimensions *die, fg_die_origin *origin) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  const char *name = cJSON_IsString(schema) ? schema->valuestring : "";
  bool measured = !strcmp(name, "foilgauge/die/1");
  if (!measured && strcmp(name, "foilgauge/next_die/1") != 0 &&
      strcmp(name, "foilgauge/expected/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "no die: neither a report of `foilgauge die -o` nor of "
                   "`foilgauge die --target -o`");
  *origin = measured ? FG_DIE_AS_MEASURED : FG_DIE_AS_CUT;
  FG_TRY(check_die_design(
      ctx, cJSON_GetObjectItemCaseSensitive(root, measured ? "design" : "target"), design));
  FG_TRY(measured ? read_measured_die(ctx, root, die) : read_die_to_cut(ctx, root, die));
  if (!is_size(die->overall_radius_mm) || (die->bumps && !is_size(die->pitch_deg)))
    return fg_fail(ctx, FG_ERR_DATA, "the die has no overall radius");
  return FG_OK;
}

fg_status fg_die_dimensions_load(fg_context *ctx, const char *path, const fg_design *design,
                                 size_t bumps, fg_die_dimensions *die, fg_die_origin *origin) {
  char *text = NULL;
  cJSON *root;
  fg_context inner = {.message = ""};
  FG_TRY(fg_die_dimensions_of_design(ctx, design, bumps, die));
  FG_TRY(fg_file_read_text(ctx, path, DIE_REPORT_BYTES, &text));
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  status = read_die_report(&inner, root, design, die, origin);
  cJSON_Delete(root);
  if (status == FG_OK) status = fg_die_dimensions_derive(&inner, design, die);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s: %.*s", path, 700, inner.message);
}
