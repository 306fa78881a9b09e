/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scale of the response as a rival of claims: an unequal scatter and an interaction may both come
 * from a scale on which effects do not add. */
#ifndef FG_TABLE_LOOP_RESPONSE_SCALE_H
#define FG_TABLE_LOOP_RESPONSE_SCALE_H

#include "table_loop/run.h"

/* Claims the scatter that another scale proves, where neither scatter nor interaction is claimed;
 * fg_engine_profile_scale ties it with that scale. */
fg_status fg_engine_accept_scale(fg_context *ctx, fg_engine_run *run);
/* Fills result->scale, and ties the claims that do not show on that scale with it. */
fg_status fg_engine_profile_scale(fg_context *ctx, fg_engine_run *run);

#endif
