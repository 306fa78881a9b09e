/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the result of the loop on scans (foilgauge/scan_result.h), each filled from search and
 * fit. verdict.c makes the decisions and calls them. */
#ifndef FG_SCAN_LOOP_RESULT_H
#define FG_SCAN_LOOP_RESULT_H

#include "effect/set.h"
#include "field/field.h"
#include "foilgauge/scan_result.h"

/* Share of the residual sum from which a listed effect alone resembles a curve. */
#define FG_SCAN_LOOP_NEAR_SHARE 0.3

struct fg_scan_loop;

/* Writes the numbers of an effect; returns how many. */
size_t fg_scan_result_put_parameters(const fg_effect_found *effect,
                                     fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS]);

/* Fills the shape of a claim. Abscissa: x and y in mm, where edges were measured; over the foil
 * from -1 at the lip's end to 1 at the free end, outward from O; in the bump's arc from -1 to 1
 * between the fillets, away from the arc's centre, beside the bump's circle; direction of the edge
 * in degrees. */
fg_status fg_scan_result_put_shape(fg_context *ctx, const struct fg_scan_loop *loop,
                                   const fg_effect_found *effect, fg_scan_result_claim *claim);

/* Fills scans, views and rows. */
fg_status fg_scan_result_put_rows(fg_context *ctx, const struct fg_scan_loop *loop,
                                  fg_scan_result *result);

/* Fills curves over every coordinate with effects, and the picture's grid. */
fg_status fg_scan_result_put_lines(fg_context *ctx, const struct fg_scan_loop *loop,
                                   fg_scan_result *result);
fg_status fg_scan_result_put_grid(fg_context *ctx, const struct fg_scan_loop *loop,
                                  fg_scan_result *result);

/* Fills the noise of the rows. */
fg_status fg_scan_result_put_noise(fg_context *ctx, const struct fg_scan_loop *loop,
                                   fg_scan_result *result);

/* Fills the bumps against the declared springback, and the notes. */
fg_status fg_scan_result_put_bumps(fg_context *ctx, const struct fg_scan_loop *loop,
                                   fg_scan_result *result);

/* Frees everything; the result is empty then. */
void fg_scan_result_free(fg_scan_result *result);

#endif
