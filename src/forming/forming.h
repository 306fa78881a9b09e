/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run of `form` without its circles: what a fit needs hundreds of times. */
#ifndef FG_FORMING_FORMING_H
#define FG_FORMING_FORMING_H

#include "foilgauge/forming.h"

/* As fg_forming_run, but nothing is drawn or fitted; after an error, too, `forming` must be freed.
 */
fg_status fg_forming_bend(fg_context *ctx, const fg_design *design,
                          const fg_forming_material *material, const fg_forming_schedule *schedule,
                          const fg_forming_options *options, fg_forming *forming);

/* FG_ERR_DATA: a temperature where the material has no yield stress any more. `where`: of which
 * file and row, with what joins it to the words; "" without. */
fg_status fg_forming_too_hot(fg_context *ctx, const char *where,
                             const fg_forming_material *material, double temperature_C);

#endif
