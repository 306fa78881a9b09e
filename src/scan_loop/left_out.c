/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils that the loop leaves out. A foil of another design has no geometry to compare its edges
 * with, and would distort the effects of the scanner. */
#include <stdio.h>
#include <stdlib.h>

#include "scan_loop/state.h"

/* A foil that is left out is one that was not measured: all that follows passes it by. */
static void give_up(fg_foil *foil) {
  char why[sizeof foil->error];
  snprintf(why, sizeof why, "%s", foil->error);
  fg_foil_give_up(foil, why);
  free(foil->bumps);
  free(foil->labels);
  foil->bumps = NULL;
  foil->labels = NULL;
  foil->bump_count = 0;
}

fg_status fg_scan_loop_leave_out(fg_context *ctx, fg_scan_loop *loop) {
  const fg_foil *first = NULL;
  const fg_measurement *of = NULL;
  size_t foils = 0;
  loop->left_out = 0;
  for (size_t i = 0; i < loop->scan_count; i++) {
    fg_measurement *m = &loop->before[i];
    for (size_t f = 0; f < m->foil_count; f++, foils++) {
      if (fg_foil_is_measured(&m->foils[f])) continue;
      give_up(&m->foils[f]);
      loop->left_out++;
      if (!first) of = m;
      if (!first) first = &m->foils[f];
    }
  }
  if (!loop->left_out || loop->left_out < foils) return FG_OK;
  return fg_fail(ctx, FG_ERR_NOT_MEASURED,
                 "%s: no foil to close the loop on: foil %d could not be measured: %s%s", of->scan,
                 first->number, first->error, foils > 1 ? "; the others neither" : "");
}

fg_status fg_scan_loop_say_left_out(fg_context *ctx, fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++) {
      const fg_foil *foil = &loop->before[i].foils[f];
      if (foil->flags & FG_FOIL_NOT_MEASURED)
        FG_TRY(fg_scan_loop_bumps_note(ctx, &loop->bumps, "%.120s foil %d is left out: %s",
                                       loop->before[i].scan, foil->number, foil->error));
    }
  return FG_OK;
}
