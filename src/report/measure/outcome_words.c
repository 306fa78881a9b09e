/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/outcome_words.h"

#include "report/measure/cures.h"

/* Counts by tolerance of the design. */
typedef struct tally {
  const fg_design *design;
  fg_verdict verdict;
  size_t count[FG_TOLERANCES_MAX];
  fg_cures cures;
  const fg_quantity *row[FG_TOLERANCES_MAX];
} tally;

static void count_decision(tally *sum, fg_decision *decision) {
  for (size_t i = 0; i < decision->count; i++) {
    const fg_judgement *one = &decision->judgements[i];
    if (one->verdict != sum->verdict || one->missing) continue;
    size_t at = (size_t)(one->tolerance - sum->design->tolerances);
    sum->count[at]++;
    sum->row[at] = one->row;
  }
  if (sum->verdict == FG_VERDICT_UNDECIDED) fg_cures_add(&sum->cures, decision);
  fg_decision_free(decision);
}

static fg_status count_scan(fg_context *ctx, const fg_measurement *measurement, tally *sum) {
  fg_decision decision;
  for (size_t i = 0; i < measurement->foil_count; i++) {
    FG_TRY(fg_foil_decide(ctx, sum->design, &measurement->foils[i], &decision));
    count_decision(sum, &decision);
  }
  for (size_t i = 0; i < measurement->disc_count; i++) {
    FG_TRY(fg_disc_decide(ctx, sum->design, &measurement->discs[i], &decision));
    count_decision(sum, &decision);
  }
  return FG_OK;
}

fg_status fg_report_write_cures(fg_context *ctx, const fg_report *report, FILE *out) {
  tally sum = {.design = report->design, .verdict = FG_VERDICT_UNDECIDED};
  for (size_t i = 0; i < report->scan_count; i++)
    if (report->scans[i].measurement) FG_TRY(count_scan(ctx, report->scans[i].measurement, &sum));
  for (size_t i = 0; i < sum.cures.count; i++)
    fprintf(out, "What decides it: %s\n", sum.cures.list[i]);
  return FG_OK;
}

fg_status fg_report_write_quantities(fg_context *ctx, const fg_report *report, fg_verdict verdict,
                                     FILE *out) {
  tally sum = {.design = report->design, .verdict = verdict};
  const char *separator = ": ";
  for (size_t i = 0; i < report->scan_count; i++)
    if (report->scans[i].measurement) FG_TRY(count_scan(ctx, report->scans[i].measurement, &sum));
  for (size_t i = 0; i < report->design->tolerance_count; i++) {
    if (!sum.count[i]) continue;
    fprintf(out, "%s%s", separator, sum.row[i]->words);
    if (sum.count[i] > 1) fprintf(out, " (%zu)", sum.count[i]);
    separator = ", ";
  }
  return FG_OK;
}
