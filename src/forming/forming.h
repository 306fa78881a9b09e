/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forming without circles or drawing, for a fit that repeats it hundreds of times. */
#ifndef FG_FORMING_FORMING_H
#define FG_FORMING_FORMING_H

#include "foilgauge/forming.h"

/* As fg_forming_run, without drawing or fitting circles; `forming` must be freed after an error,
 * too. */
fg_status fg_forming_bend(fg_context *ctx, const fg_design *design,
                          const fg_forming_material *material, const fg_forming_schedule *schedule,
                          const fg_forming_options *options, fg_forming *forming);

/* FG_ERR_DATA: at this temperature the material has no yield stress. `where`: file and row with
 * their joining words; "" without. */
fg_status fg_forming_too_hot(fg_context *ctx, const char *where,
                             const fg_forming_material *material, double temperature_C);

#endif
