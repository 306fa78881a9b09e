/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Displacement by the scanner, as the mean over all models that have weight, and the uncertainty of
 * the part's circles that it leaves. */
#ifndef FG_EVIDENCE_DISPLACEMENT_H
#define FG_EVIDENCE_DISPLACEMENT_H

#include "evidence/shift.h"

enum { FG_DISPLACEMENT_EFFECTS = 24, FG_DISPLACEMENT_RIVALS = 8 };

/* Terms with mean amplitudes, um. */
typedef struct fg_displacement {
  fg_field_frame frame;
  struct {
    const fg_effect *effect; /* a polynomial: the powers of its axis */
    double shape[FG_FIELD_SHAPES], um[FG_EFFECT_COLUMNS_MAX];
    size_t columns;
  } effect[FG_DISPLACEMENT_EFFECTS];
  size_t effects;
  struct {
    const fg_rival *rival;
    double um[FG_RIVAL_COLUMNS];
  } rival[FG_DISPLACEMENT_RIVALS];
  size_t rivals;
} fg_displacement;

/* Occam's window (Madigan and Raftery 1994): models that are not far less likely than the best and
 * include none that is likelier, with their weights, sum 1. */
enum { FG_EVIDENCE_WINDOW = 48 };
typedef struct fg_evidence_window {
  const fg_evidence_model *model[FG_EVIDENCE_WINDOW];
  double weight[FG_EVIDENCE_WINDOW];
  size_t count;
} fg_evidence_window;

/* Fills the window that displacement and map are means over. `found`: the one set of causes of the
 * verdict, which all models of the window hold then. NULL: the models that the verdict does not
 * tell apart. */
fg_status fg_evidence_list_window(fg_context *ctx, fg_evidence_search *search,
                                  const fg_evidence_model *found, fg_evidence_window *window);

/* Returns the effect whose columns a part has on the glass: of a polynomial the powers of its axis.
 */
const fg_effect *fg_evidence_glass_effect(const fg_evidence_part *part);

/* Returns the displacement of a place on the glass, mm. */
fg_point fg_displacement_at(const fg_displacement *displacement, fg_point at);

/* Fills the mean displacement over the window and, per part of the edge fit, its covariance;
 * `parts` are allocated. */
fg_status fg_evidence_find_displacement(fg_context *ctx, fg_evidence_search *search,
                                        const fg_evidence_window *window,
                                        fg_displacement *displacement, fg_displacement_part *parts);

#endif
