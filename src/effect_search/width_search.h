/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which effects of the strip's width there are: what moves its edges apart leaves the midline, and
 * with it every residual of the points, as it is.
 *
 * Half the width of every row, with the stretch by the scanner's fields taken out, is a level of
 * its view, the edge model's error, and all effects of the width at once, by least squares. The
 * edge model errs with the direction of the edge and with its bend, so these are fitted as well; it
 * may err with the place on the glass, which in one scan is nearly the same as the place along the
 * foil, so that is allowed for in the uncertainty. Widths are correlated along an edge and over a
 * bump: bumps and lands are the units, not rows.
 */
#ifndef FG_EFFECT_SEARCH_WIDTH_SEARCH_H
#define FG_EFFECT_SEARCH_WIDTH_SEARCH_H

#include "effect/set.h"

enum { FG_WIDTH_EFFECTS_MAX = 8 };

typedef struct fg_width_effect {
  fg_effect_found effect; /* its number, also when it is not claimed */
  bool found;
  double p_value;
  double share;         /* of its square, what level and edge model leave */
  double would_explain; /* of the widths' square, alone */
  double smallest_um;   /* amplitude that would have shown */
} fg_width_effect;

typedef struct fg_width_findings {
  fg_width_effect each[FG_WIDTH_EFFECTS_MAX];
  size_t count; /* effects that were looked for; 0: there is no width */
  size_t found;
  double rms_before_um, rms_after_um; /* of half the width about its view's mean */
} fg_width_findings;

/* `set`: in force, fitted to the points. Views that are kept aside have no say. */
fg_status fg_search_width(fg_context *ctx, const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          fg_width_findings *findings);

#endif
