/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing as `foilgauge stiffness` tested it: clearance and stiffness of its bumps by azimuth. */
#include <cjson/cJSON.h>
#include <math.h>
#include <string.h>

#include "film/bearing.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* One azimuth; a travel along it is one along the opposite, so that azimuths lie in 0 to 180. */
typedef struct tested_axis {
  double azimuth_deg, gap_mm, u_mm, u_repeat_mm, travel_mm, stiffness_n_mm;
} tested_axis;

enum { TESTED_AXES_MAX = 360 };
typedef struct tested_bearing {
  tested_axis axis[TESTED_AXES_MAX];
  size_t count;
} tested_bearing;

static double number_of(const cJSON *object, const char *name) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

static double half_turn(double angle_deg) {
  double rest = fmod(angle_deg, 180);
  return rest < 0 ? rest + 180 : rest;
}

static fg_status read_axis(fg_context *ctx, const fg_film_report *r, const cJSON *item,
                           tested_bearing *tested) {
  const tested_axis axis = {.azimuth_deg = half_turn(number_of(item, "azimuth_deg")),
                            .gap_mm = number_of(item, "gap_mm"),
                            .u_mm = number_of(item, "u_gap_mm"),
                            .u_repeat_mm = number_of(item, "u_repeat_gap_mm"),
                            .travel_mm = number_of(item, "travel_mm"),
                            .stiffness_n_mm = number_of(item, "stiffness_n_mm")};
  if (!isfinite(axis.azimuth_deg) || !(axis.gap_mm > 0) || !(axis.travel_mm > axis.gap_mm) ||
      !(axis.stiffness_n_mm > 0))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: azimuth %g has no gap, or no stiffness behind it: a film needs both",
                   r->options.foils, number_of(item, "azimuth_deg"));
  for (size_t i = 0; i < tested->count; i++)
    if (fabs(remainder(tested->axis[i].azimuth_deg - axis.azimuth_deg, 180)) < 1e-6)
      return fg_fail(ctx, FG_ERR_DATA, "%s: the axis of azimuth %g is there twice",
                     r->options.foils, number_of(item, "azimuth_deg"));
  if (tested->count == TESTED_AXES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "%s: more than %d azimuths; test the bearing at fewer",
                   r->options.foils, TESTED_AXES_MAX);
  tested->axis[tested->count++] = axis;
  return FG_OK;
}

static fg_status read_axes(fg_context *ctx, const fg_film_report *r, const cJSON *root,
                           tested_bearing *tested) {
  const cJSON *item, *axes = cJSON_GetObjectItemCaseSensitive(root, "azimuths");
  int bearings = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(root, "bearings"));
  if (bearings != 1)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the report is of %d bearings, and a film is of one: test that one alone",
                   r->options.foils, bearings);
  cJSON_ArrayForEach(item, axes) FG_TRY(read_axis(ctx, r, item, tested));
  return tested->count
             ? FG_OK
             : fg_fail(ctx, FG_ERR_DATA,
                       "%s: no azimuths; a film needs the gap and stiffness of one at least",
                       r->options.foils);
}

/* Linear between the axes beside an azimuth, which go round in half a turn. */
static tested_axis axis_at(const tested_bearing *tested, double azimuth_deg) {
  const tested_axis *below = NULL, *above = NULL;
  double down = INFINITY, up = INFINITY;
  for (size_t i = 0; i < tested->count; i++) {
    const tested_axis *axis = &tested->axis[i];
    double behind = half_turn(azimuth_deg - axis->azimuth_deg);
    double ahead = half_turn(axis->azimuth_deg - azimuth_deg);
    if (behind < down) down = behind, below = axis;
    if (ahead < up) up = ahead, above = axis;
  }
  double share = down + up > 0 ? down / (down + up) : 0;
  tested_axis at = *below;
  double *const values[] = {&at.gap_mm, &at.u_mm, &at.u_repeat_mm, &at.travel_mm,
                            &at.stiffness_n_mm};
  const double others[] = {above->gap_mm, above->u_mm, above->u_repeat_mm, above->travel_mm,
                           above->stiffness_n_mm};
  for (size_t k = 0; k < sizeof others / sizeof *others; k++)
    *values[k] += share * (others[k] - *values[k]);
  return at;
}

/* Stiffness of a bump per width. At the end of the travel the rotor touches as far round as gap /
 * travel = cos(reach), and a bump there gives way by the cosine, against the push by it once more:
 * K = k L N / (2 pi) (reach + sin(reach) cos(reach)). */
static double bump_stiffness(const fg_film_report *r, const tested_axis *axis) {
  double cosine = axis->gap_mm / axis->travel_mm, reach = acos(cosine);
  double bumps_per_rad = 1 / (r->options.pitch_deg * rad_per_deg);
  return axis->stiffness_n_mm / (r->length_mm * bumps_per_rad * (reach + sin(reach) * cosine));
}

fg_status fg_film_read_tested(fg_context *ctx, fg_film_report *r, const cJSON *root,
                              fg_film_bearing *bearing) {
  tested_bearing tested = {.count = 0};
  if (r->options.bore)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: the gap of a test holds the bore already: drop %s",
                   r->options.foils, r->options.bore);
  FG_TRY(read_axes(ctx, r, root, &tested));
  double zero = number_of(cJSON_GetObjectItemCaseSensitive(root, "options"), "azimuth_zero_deg");
  for (size_t i = 0; i < bearing->count; i++) {
    tested_axis at = axis_at(&tested, bearing->angle_deg[i] + (isfinite(zero) ? zero : 0));
    bearing->clearance_mm[i] = at.gap_mm / 2;
    bearing->stiffness_n_mm2[i] = bump_stiffness(r, &at);
    double repeat = isfinite(at.u_repeat_mm) ? fmin(at.u_repeat_mm, at.u_mm) : 0;
    if (!(at.u_mm > 0)) continue;
    r->u_own_mm[i] = repeat / 2;
    r->u_shared_mm[i] = sqrt((at.u_mm - repeat) * (at.u_mm + repeat)) / 2;
  }
  return FG_OK;
}
