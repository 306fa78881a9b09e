/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FG_TABLE_LOOP_SUSPECT_H
#define FG_TABLE_LOOP_SUSPECT_H

#include "table_loop/step.h"

/* Lists the suspects of a step in which nothing was claimed, the clearest first; the verdict is
 * then `suspected`. */
fg_status fg_engine_list_suspects(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step);

#endif
