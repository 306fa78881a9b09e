/* Values and units as people read them. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/scan_loop/scan_loop_parts.h"

double fg_scan_loop_nice_below(double most) {
  double power = pow(10, floor(log10(most))), share = most / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

const char *fg_scan_loop_unit_words(const char *unit) {
  return !strcmp(unit, "um") ? "µm" : !strcmp(unit, "deg") ? "°" : unit;
}

const char *fg_scan_loop_held_out_words(const fg_scan_result *result) {
  switch (result->held_out) {
  case FG_SCAN_HELD_OUT_SCANS:
    return "scans kept aside";
  case FG_SCAN_HELD_OUT_FOLDS:
    return result->discs ? "discs that took no part in the search"
                         : "bumps that took no part in the search";
  default:
    return NULL;
  }
}

const char *fg_scan_loop_witness_word(fg_scan_witness_verdict verdict) {
  switch (verdict) {
  case FG_WITNESS_FOR:
    return "for";
  case FG_WITNESS_AGAINST:
    return "against";
  case FG_WITNESS_CANNOT_TELL:
    return "cannot_tell";
  case FG_WITNESS_NONE:
    break;
  }
  return "";
}
