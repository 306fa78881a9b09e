/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs of `loop`, on tables and on scans. */
#ifndef FG_CLI_LOOP_OUTPUTS_H
#define FG_CLI_LOOP_OUTPUTS_H

#include "cli/output_set.h"

typedef enum fg_loop_output {
  FG_LOOP_HTML,
  FG_LOOP_MODEL,
  FG_LOOP_JSON,
  FG_LOOP_TEXT,
  FG_LOOP_OUTPUTS
} fg_loop_output;

/* Sends results without -o to standard output: as text on a terminal, else as JSON where no file
 * was asked for. */
void fg_loop_outputs_choose(fg_output_set *set);

#endif
