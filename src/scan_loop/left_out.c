/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils that the loop leaves out. A foil of another design has no geometry to compare its edges
 * with, and would distort the effects of the scanner. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/spread.h"
#include "scan_loop/state.h"

/* A stretch between two arcs that is longer than the foil's fillets by this ratio, and by this
 * length, is more than a fillet. */
#define LONG_RATIO 2.0
#define LONG_MM    0.2

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

/* Stations between two arcs of a foil, from `first` on, and the bump beside them. */
typedef struct stretch {
  size_t first, count;
  int bump;
} stretch;

/* Fills the stretches; returns their number. */
static size_t list_stretches(const fg_foil *foil, stretch *to) {
  const fg_station_label *label = foil->labels;
  size_t count = 0;
  for (size_t k = 1; k < foil->strip.count; k++) {
    if (label[k].kind == FG_ARC_FILLET && label[k - 1].kind != FG_ARC_FILLET)
      to[count++] = (stretch){.first = k, .bump = label[k - 1].number};
    if (label[k].kind == FG_ARC_FILLET && count) to[count - 1].count++;
    if (label[k].kind == FG_ARC_BUMP && label[k - 1].kind == FG_ARC_FILLET && count)
      to[count - 1].bump = label[k].number;
    if (label[k].kind == FG_ARC_LAND && label[k - 1].kind == FG_ARC_FILLET && count)
      to[count - 1].bump = label[to[count - 1].first - 1].number;
  }
  return count;
}

/* Edges that follow neither a bump nor the lands are in no fit: nothing that is said of a foil
 * holds for them. */
static fg_status say_stretches(fg_context *ctx, fg_scan_loop *loop, const char *scan,
                               const fg_foil *foil) {
  stretch *all = NULL;
  double *length = NULL, step_mm = foil->strip.step_mm;
  fg_status status = FG_OK;
  if (!foil->labels || !foil->strip.count) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, foil->strip.count, sizeof *all, (void **)&all));
  size_t count = list_stretches(foil, all);
  if (!count) goto exit;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *length, (void **)&length));
  for (size_t i = 0; i < count; i++)
    length[i] = step_mm * (double)all[i].count;
  double usual = fg_median(length, count);
  for (size_t i = 0; i < count; i++) {
    double mm = step_mm * (double)all[i].count;
    if (mm <= fmax(LONG_RATIO * usual, usual + LONG_MM)) continue;
    FG_TRY_EXIT(fg_scan_loop_bumps_note(
        ctx, &loop->bumps,
        "%.120s foil %d: beside bump %d the strip follows neither a bump nor the lands over %.2f "
        "mm, "
        "as if it were creased there: these edges are in no fit, and nothing is said of them",
        scan, foil->number, all[i].bump, mm));
  }
exit:
  free(all);
  free(length);
  return status;
}

fg_status fg_scan_loop_note_left_out(fg_context *ctx, fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++) {
      const fg_foil *foil = &loop->before[i].foils[f];
      if (foil->flags & FG_FOIL_NOT_MEASURED)
        FG_TRY(fg_scan_loop_bumps_note(ctx, &loop->bumps, "%.120s foil %d is left out: %s",
                                       loop->before[i].scan, foil->number, foil->error));
      else
        FG_TRY(say_stretches(ctx, loop, loop->before[i].scan, foil));
    }
  return FG_OK;
}
