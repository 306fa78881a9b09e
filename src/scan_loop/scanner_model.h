/* A scanner's model in memory. */
#ifndef FG_SCAN_LOOP_SCANNER_MODEL_H
#define FG_SCAN_LOOP_SCANNER_MODEL_H

#include "explain/explain.h"
#include "field/field.h"
#include "foilgauge/scan_loop.h"

enum { FG_MODEL_DATE = 32 };

struct fg_scanner_model {
  char sha256[65]; /* of the file */
  char path[1024]; /* as given */
  char scanner[FG_SCANNER_NAME];
  char date[FG_MODEL_DATE]; /* of the newest scan it was found on; "": not said */
  double dpi[2];
  size_t scans;           /* that it was found on; 0: not said */
  size_t known_diameters; /* gauges of them; 0: its absolute scale is not known */
  bool tied;
  fg_field_list fields;
  /* What the explanations that were tied with it would correct instead. */
  fg_field_list other[FG_EXPLANATIONS_MAX];
  size_t others;
};

/* What a loop found of its scanner; free with fg_scanner_model_free. */
fg_status fg_scanner_model_of(fg_context *ctx, const fg_scan_loop *loop, fg_scanner_model **model);

/* Whether numbers are such as a scanner can have: FG_ERR_DATA names the member, its value and what
 * is allowed. What is written and what is read pass the same check. `member` is that of the list:
 * "fields", "alternatives[2]". */
fg_status fg_scanner_model_check_place(fg_context *ctx, const double dpi[2],
                                       const fg_field_frame *frame);
fg_status fg_scanner_model_check_fields(fg_context *ctx, const char *member,
                                        const fg_field_list *list);

/* Adds to every u_ of `corrected` what the uncertainties of the model's own numbers do to it. */
fg_status fg_scanner_model_widen(fg_context *ctx, const fg_scanner_model *model,
                                 const fg_measurement *m, unsigned threads,
                                 fg_measurement *corrected);

/* Adds to every u_ of `corrected` how far the other explanations would have moved its value: they
 * do equally well, so the value may lie anywhere between (a rectangle of that half width). */
fg_status fg_scanner_model_widen_tie(fg_context *ctx, const fg_scanner_model *model,
                                     const fg_measurement *m, unsigned threads,
                                     fg_measurement *corrected);

#endif
