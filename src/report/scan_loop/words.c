/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values and units as people read them. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/scan_loop/parts.h"

double fg_scan_loop_nice_below(double max) {
  double power = pow(10, floor(log10(max))), share = max / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

const char *fg_scan_loop_unit_words(const char *unit) {
  return !strcmp(unit, "um") ? "µm" : !strcmp(unit, "deg") ? "°" : unit;
}

void fg_scan_loop_held_out_words(const fg_scan_result *result, char words[FG_HELD_OUT_WORDS]) {
  words[0] = 0;
  if (result->held_out == FG_SCAN_HELD_OUT_SCANS)
    fg_text_clip(words, FG_HELD_OUT_WORDS, "scans kept aside");
  if (result->held_out == FG_SCAN_HELD_OUT_FOLDS)
    fg_text_clip(words, FG_HELD_OUT_WORDS, "%s that took no part in the fit", result->fold_of);
}
