/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for the effects that explain the rows of an edge fit.
 *
 * The smooth effects of scanner and part are nearly collinear in one scan (correlations 0.83 to
 * 0.99), so a search that adds the best effect first can accept a wrong one and never drop it. They
 * are few: all sets of up to two (three where a part was scanned more than once) are fitted beside
 * the geometry, together with ripples and steps, which are told apart easily. The set of all
 * effects and free curves is the reference. Sets of the smallest size that leave no more than this
 * reference, within noise and the edge model's own error, are explanations, tied when there are
 * several. When there are none, a free curve, alone or beside up to two listed effects, is the
 * explanation.
 *
 * The width of the strip orders tied sets: a scanner's field stretches it as it stretches the
 * foil, a part's effect does not. The width does not decide: an edge model whose error follows the
 * direction of the edge would look the same. */
#ifndef FG_EFFECT_SEARCH_EFFECT_SEARCH_H
#define FG_EFFECT_SEARCH_EFFECT_SEARCH_H

#include "effect_search/explanations.h"

/* Runs search and joint fit in turns (iterate.h). Effects that discs do not confirm from one to the
 * next are barred, and it starts again. `set` gets the winner, fitted; `residual_um` (rows) its
 * residual. */
fg_status fg_search_run(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                        fg_explanations *explanations, double *residual_um);

#endif
