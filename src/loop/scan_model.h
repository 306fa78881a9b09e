/* A scanner's model in memory. */
#ifndef FG_LOOP_SCAN_MODEL_H
#define FG_LOOP_SCAN_MODEL_H

#include "foilgauge/scan_loop.h"
#include "loop/fields.h"
#include "loop/subset.h"

struct fg_scan_model {
  char sha256[65]; /* of the file */
  char scanner[FG_SCANNER_NAME];
  double dpi[2];
  bool tied;
  fg_field_list fields;
  /* What the explanations that were tied with it would correct instead. */
  fg_field_list other[FG_SUBSET_CLASS];
  size_t others;
};

/* Adds to every u_ of `corrected` how far the other explanations would have moved its value: they
 * do equally well, so the value may lie anywhere between (a rectangle of that half width). */
fg_status fg_scan_model_widen_tie(fg_context *ctx, const fg_scan_model *model,
                                  const fg_measurement *m, unsigned threads,
                                  fg_measurement *corrected);

#endif
