/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/stiffness/map.h"

#include <math.h>
#include <stdio.h>

#include "page/plot_frame.h"

/* Colour is full at ± 40 %: the stiffness of lots varies by less. */
static const double full_colour = 0.4;

enum { STEPS = 120, JSON_STEPS = 10 };

fg_stiffness_map fg_stiffness_map_around(const fg_design *design,
                                         const fg_arch_material *material) {
  return (fg_stiffness_map){design, material, 0.9, 1.35, 0.7, 1.1};
}

static double stiffness_at(const fg_stiffness_map *map, double radius_ratio, double angle_ratio) {
  const fg_design *design = map->design;
  fg_arch_stiffness stiffness;
  fg_context unused;
  const fg_arch arch =
      fg_design_arch(design, design->thickness_mm, design->bumps.radius_mm * radius_ratio,
                     design->bumps.angle_deg * angle_ratio);
  if (fg_arch_free(&unused, &arch, map->material, &stiffness) != FG_OK) return NAN;
  return stiffness.stiffness_n_mm2;
}

double fg_stiffness_map_at(const fg_stiffness_map *map, double radius_ratio, double angle_ratio) {
  return stiffness_at(map, radius_ratio, angle_ratio) / stiffness_at(map, 1, 1);
}

/* Blue below 1, orange above. */
static unsigned colour_of(double ratio) {
  double share = fmax(-1, fmin(1, (ratio - 1) / full_colour)), rest = 1 - fabs(share);
  double warm[3] = {217, 95, 2}, cold[3] = {31, 111, 208};
  const double *end = share > 0 ? warm : cold;
  unsigned colour = 0;
  for (int i = 0; i < 3; i++)
    colour = colour << 8 | (unsigned)lround(end[i] * (1 - rest) + 252 * rest);
  return colour;
}

static void put_cells(const fg_plot *at, const fg_stiffness_map *map) {
  enum { COLUMNS = 44, ROWS = 26 };
  double dx = (at->x_high - at->x_low) / COLUMNS, dy = (at->y_high - at->y_low) / ROWS;
  double design = stiffness_at(map, 1, 1);
  for (int i = 0; i < COLUMNS; i++)
    for (int k = 0; k < ROWS; k++) {
      double x = at->x_low + i * dx, y = at->y_low + k * dy;
      double ratio = stiffness_at(map, x + dx / 2, y + dy / 2) / design;
      if (!isfinite(ratio)) continue;
      fprintf(at->out,
              "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#%06x\"/>\n",
              fg_plot_x(at, x), fg_plot_y(at, y + dy), (at->right - at->left) / COLUMNS + 0.5,
              (at->bottom - at->top) / ROWS + 0.5, colour_of(ratio));
    }
}

/* Largest angle of a bump: less than a half circle. */
static const double half_circle_deg = 179.9;

/* Returns the angle where stiffness is `level` at this radius, by bisection (it falls as the
 * angle grows); NaN: not on the map. */
static double angle_of(const fg_plot *at, const fg_stiffness_map *map, double radius,
                       double level) {
  enum { HALVINGS = 20 }; /* far finer than a pixel */
  double low = at->y_low, high = fmin(at->y_high, half_circle_deg / map->design->bumps.angle_deg);
  double sought = level * stiffness_at(map, 1, 1);
  if (!(stiffness_at(map, radius, low) > sought && stiffness_at(map, radius, high) < sought))
    return NAN;
  for (int step = 0; step < HALVINGS; step++) {
    double middle = (low + high) / 2;
    if (stiffness_at(map, radius, middle) > sought)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Writes the number on the rising diagonal, which every line of equal stiffness crosses once. */
static void put_level(const fg_plot *at, const fg_stiffness_map *map, double level) {
  double x[STEPS + 1], y[STEPS + 1], nearest = INFINITY;
  int place = -1;
  char text[16];
  for (int i = 0; i <= STEPS; i++) {
    x[i] = at->x_low + (at->x_high - at->x_low) * i / STEPS;
    y[i] = angle_of(at, map, x[i], level);
    double apart = fabs((y[i] - at->y_low) / (at->y_high - at->y_low) - (double)i / STEPS);
    if (!(apart < nearest)) continue;
    nearest = apart;
    place = i;
  }
  if (place < 0) return;
  fg_plot_line(at, x, y, STEPS + 1, level == 1 ? "hypothesis" : "contour");
  snprintf(text, sizeof text, "%.3g", level);
  if (place > 2 && place < STEPS - 2) fg_plot_text(at, x[place], y[place], "level", text);
}

/* alpha / alpha_D where the arc length stays. */
static void put_constant_arc(const fg_plot *at) {
  double x[STEPS + 1], y[STEPS + 1];
  for (int i = 0; i <= STEPS; i++) {
    x[i] = at->x_low + (at->x_high - at->x_low) * i / STEPS;
    y[i] = 1 / x[i] >= at->y_low && 1 / x[i] <= at->y_high ? 1 / x[i] : NAN;
  }
  fg_plot_line(at, x, y, STEPS + 1, "fit");
}

void fg_stiffness_plot_map(FILE *out, const fg_stiffness_map *map, fg_stiffness_dots *dots,
                           const void *user) {
  static const double levels[] = {0.4, 0.5, 0.6, 0.7,  0.8, 0.9, 1, 1.1,
                                  1.2, 1.3, 1.5, 1.75, 2,   2.5, 3};
  fg_plot at = fg_plot_open(
      out, &(fg_plot_frame){
               "Stiffness of a bump over its radius and angle, all over the design's",
               .height = 430, .left = 92, .x = (double[]){map->radius_low, map->radius_high},
               .y = (double[]){map->angle_low, map->angle_high},
               .y_title = "angle over the design's", .x_title = "bump radius over the design's"});
  put_cells(&at, map);
  fg_plot_axes(&at);
  put_constant_arc(&at);
  for (size_t i = 0; i < sizeof levels / sizeof *levels; i++)
    put_level(&at, map, levels[i]);
  if (dots) dots(&at, user);
  fg_plot_end(&at);
}

/* Values of an axis in JSON. */
static const double *list_axis(double low, double high, double *values, size_t *count) {
  *count = JSON_STEPS + 1;
  for (int i = 0; i <= JSON_STEPS; i++)
    values[i] = low + (high - low) * i / JSON_STEPS;
  return values;
}

static const double *list_radii(const fg_subject *subject, double *values, size_t *count) {
  const fg_stiffness_map *map = subject->object;
  return list_axis(map->radius_low, map->radius_high, values, count);
}

static const double *list_angles(const fg_subject *subject, double *values, size_t *count) {
  const fg_stiffness_map *map = subject->object;
  return list_axis(map->angle_low, map->angle_high, values, count);
}

/* Stiffness at one angle, which the subject's index counts. */
static const double *list_ratios(const fg_subject *subject, double *values, size_t *count) {
  double angle[JSON_STEPS + 1];
  list_angles(subject, angle, count);
  list_radii(subject, values, count);
  for (size_t i = 0; i < *count; i++)
    values[i] = fg_stiffness_map_at(subject->object, values[i], angle[subject->index]);
  return values;
}

static bool find_angle(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i <= JSON_STEPS;
}

static const char *find_arch_id(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return fg_stiffness_models()[0].id;
}

static const fg_member ratio_rows[] = {{FG_NUMBERS_BY(NULL, list_ratios)}};
static const fg_members ratio_members = FG_MEMBERS(ratio_rows);

static const fg_member map_rows[] = {
    {FG_TEXT_BY("model", find_arch_id), .schema = "{\"const\": \"arch\"}"},
    {FG_NUMBERS_BY("radius_over_design", list_radii), .options = FG_MEMBER_NEVER_NULL,
     .lowest = JSON_STEPS + 1, .highest = JSON_STEPS + 1},
    {FG_NUMBERS_BY("bump_angle_over_design", list_angles), .options = FG_MEMBER_NEVER_NULL,
     .lowest = JSON_STEPS + 1, .highest = JSON_STEPS + 1},
    {FG_LIST_BY("normalised", find_angle, &ratio_members),
     .words = "normalised[k][i]: stiffness over the design's at bump_angle_over_design[k] and "
              "radius_over_design[i]"},
};
const fg_members fg_stiffness_map_members = FG_MEMBERS_OF_FILE(map_rows, "map", "nominal");
