/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Die and heat treatment together, where an experiment tells how springback depends on it. */
#ifndef FG_COMPENSATION_SETTING_H
#define FG_COMPENSATION_SETTING_H

#include "foilgauge/compensation.h"

/* Fills the settings of `next`, whose laws and die are found. FG_ERR_DATA, FG_ERR_USAGE: runs that
 * cannot be analysed, a setting that does not name every factor. */
fg_status fg_setting_trade_find(fg_context *ctx, const fg_setting_request *request,
                                fg_next_die *next);

#endif
