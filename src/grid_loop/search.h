/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Listed effects of the scanner in the residuals of grids. */
#ifndef FG_GRID_LOOP_SEARCH_H
#define FG_GRID_LOOP_SEARCH_H

#include "grid_loop/solve.h"

/* Puts the effects into the model that every scanner may have: ratio of the axes, shear, and scale
 * where it can be told. */
void fg_grid_begin_effects(grid_problem *problem);

/* Adds listed effects while one stands out of the residual by more than the best of all candidates
 * does by chance. */
fg_status fg_grid_add_effects(fg_context *ctx, grid_problem *problem);

/* Moves the shapes of added effects to the best places beside all others and the map. */
fg_status fg_grid_refine_effects(fg_context *ctx, grid_problem *problem);

/* Puts the shapes of waves and lengths among the unknowns, about where they are: all uncertainties
 * then hold theirs. */
fg_status fg_grid_loosen_shapes(fg_context *ctx, grid_problem *problem);

/* Drops added effects that are not told beside all others and the map. */
fg_status fg_grid_prune_effects(fg_context *ctx, grid_problem *problem);

/* Number of effects that fg_grid_begin_effects adds. */
size_t fg_grid_own_effects(const grid_problem *problem);

/* (amplitude / uncertainty)² of an effect, of both columns together. */
double fg_grid_effect_chi2(const grid_problem *problem, const grid_solution *solution,
                           size_t effect);

#endif
