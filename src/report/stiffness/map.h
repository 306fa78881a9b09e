/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a bump over its radius and angle, all over the design's (thesis figures 5.4, 5.10):
 * the arch of foilgauge/bearing.h, strips as thick as designed. */
#ifndef FG_REPORT_STIFFNESS_MAP_H
#define FG_REPORT_STIFFNESS_MAP_H

#include "core/member.h"
#include "foilgauge/stiffness.h"
#include "page/plot.h"

typedef struct fg_stiffness_map {
  const fg_design *design;
  const fg_arch_material *material;
  double radius_low, radius_high, angle_low, angle_high; /* over the design's */
} fg_stiffness_map;

/* Returns a map around the design, over the range of springback that was measured: radii 0.9 to
 * 1.35 of the design's, angles 0.7 to 1.1 (thesis figure 5.8: 0.95 to 1.3 at constant arc
 * length). */
fg_stiffness_map fg_stiffness_map_around(const fg_design *design, const fg_arch_material *material);

/* Returns the ratio of stiffness; NaN where these ratios give no bump. */
double fg_stiffness_map_at(const fg_stiffness_map *map, double radius_ratio, double angle_ratio);

/* Draws dots on top of the map. */
typedef void fg_stiffness_dots(const fg_plot *at, const void *user);

/* Writes one <svg>; `dots` may be NULL. */
void fg_stiffness_plot_map(FILE *out, const fg_stiffness_map *map, fg_stiffness_dots *dots,
                           const void *user);

extern const fg_members fg_stiffness_map_members;

#endif
