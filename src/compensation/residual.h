/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop over the springback of all lots: does it hold an effect that the law has no term for? */
#ifndef FG_COMPENSATION_RESIDUAL_H
#define FG_COMPENSATION_RESIDUAL_H

#include "foilgauge/compensation.h"

/* Fills the loop's members of the check. Lots whose folders are gone or changed take no part. */
fg_status fg_springback_loop(fg_context *ctx, fg_expected_check *check);

#endif
