/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for effects of the strip's width. An effect that moves the strip's edges apart leaves the
 * midline, and with it every residual of the edge fit, unchanged.
 *
 * Model of half the width of every row, less the stretch by the scanner's fields: a level per
 * scan, the edge model's error, and all effects of the width at once, by least squares. The edge
 * model's error follows the direction of the edge and its curvature, so both are fitted. It may
 * also follow the place on the glass, which in one scan is nearly collinear with the place along
 * the foil: the uncertainty allows for that. Widths are correlated along an edge and over a bump,
 * so bumps and lands are the units, not rows. */
#ifndef FG_EFFECT_SEARCH_WIDTH_SEARCH_H
#define FG_EFFECT_SEARCH_WIDTH_SEARCH_H

#include "effect/set.h"

enum { FG_WIDTH_EFFECTS_MAX = 8 };

typedef struct fg_width_effect {
  fg_effect_found effect; /* with its number, also when it is not claimed */
  bool found;
  double p_value;
  double share;         /* share of its square that level and edge model leave */
  double would_explain; /* share of the widths' square that it explains alone */
  double smallest_um;   /* smallest amplitude that would have shown */
} fg_width_effect;

typedef struct fg_width_findings {
  fg_width_effect each[FG_WIDTH_EFFECTS_MAX];
  size_t count; /* effects sought; 0: the rows have no width */
  size_t found;
  double rms_before_um, rms_after_um; /* of half the width about its scan's mean */
} fg_width_findings;

/* `set`: in force, fitted to the rows. `stretch_um`: of half the width by the scanner, one number
 * per row; NULL: that of the set. Held-out scans are not used. */
fg_status fg_search_width(fg_context *ctx, const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          const double *stretch_um, fg_width_findings *findings);

#endif
