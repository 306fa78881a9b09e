/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot that comes of a die, drawn from the posterior of the law. */
#ifndef FG_COMPENSATION_EXPECTED_H
#define FG_COMPENSATION_EXPECTED_H

#include "compensation/sets.h"
#include "compensation/springback.h"

/* Finds the law of all quantities from the sets of `next`. */
fg_status fg_formed_laws_find(fg_context *ctx, size_t bumps, fg_next_die *next);
void fg_formed_laws_free(struct fg_formed_laws *laws);

/* Fills `next->expected`, whose `foils` is set. `sets` has foils whose scatter the shares are drawn
 * from; without any the scatter is normal. */
fg_status fg_expected_lot_find(fg_context *ctx, const fg_formed_sets *sets, fg_next_die *next);

#endif
