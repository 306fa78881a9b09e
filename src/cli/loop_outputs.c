/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/loop_outputs.h"

#include <unistd.h>

void fg_loop_outputs_choose(fg_output_set *set) {
  if (set->path[FG_LOOP_JSON] || fg_output_set_has_standard(set)) return;
  if (isatty(STDOUT_FILENO))
    set->path[FG_LOOP_TEXT] = "-";
  else if (!set->path[FG_LOOP_HTML] && !set->path[FG_LOOP_MODEL])
    set->path[FG_LOOP_JSON] = "-";
}
