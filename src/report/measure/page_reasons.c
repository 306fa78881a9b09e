/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reasons of a verdict: its values, their bumps, their limits. */
#include <math.h>

#include "foilgauge/traceability.h"
#include "report/measure/cures.h"
#include "report/measure/foil_parts.h"
#include "report/measure/page_tables.h"

/* "4.042 %, max 3" of the first that lies farthest out; the others by their numbers. */
static void put_judged_number(FILE *out, const fg_judgement *one) {
  int decimals = one->row->kind == FG_QUANTITY_COUNT ? 0 : fg_report_decimals(one->row, one->u);
  if (!isfinite(one->value)) return;
  fprintf(out, " (%s%.*f%s%s, %s %.7g)", one->value < 0 ? "−" : "", decimals, fabs(one->value),
          one->row->unit[0] ? " " : "", one->row->unit, one->margin.upper ? "max" : "min",
          one->margin.limit);
}

static bool is_listed(const fg_judgement *one, fg_verdict verdict) {
  return one->verdict == verdict && !one->missing;
}

/* Judgements of one tolerance are neighbours. Missing bumps are left to the defect's words. */
static size_t put_list(FILE *out, const fg_decision *decision, fg_verdict verdict) {
  const fg_tolerance *last = NULL;
  size_t told = 0;
  for (size_t i = 0; i < decision->count; i++) {
    const fg_judgement *one = &decision->judgements[i];
    if (!is_listed(one, verdict)) continue;
    if (one->tolerance != last)
      fprintf(out, "%s%s%s%s", last ? "; " : "", one->row->words, one->number ? ": " : "",
              one->number ? fg_foil_part_word(one->row) : "");
    else
      fputc(',', out);
    if (one->number) fprintf(out, " %d", one->number);
    put_judged_number(out, one);
    last = one->tolerance;
    told++;
  }
  return told;
}

/* Writes " What decides it: ...", and before it a reason that no limit has. */
static void put_cures(FILE *out, const fg_cures *cures) {
  if (cures->count && cures->list[0] == fg_traceability_cure)
    fputs(" Nothing is known of the scanner&#39;s scale, which lengths rest on.", out);
  for (size_t i = 0; i < cures->count; i++) {
    fputs(i ? " " : " <b>What decides it:</b> ", out);
    fg_html_text(out, cures->list[i]);
  }
}

/* "Out of tolerance (3 values): bump height: bump 1 (0.53 mm, min 0.54), 8 (…)." */
void fg_html_reasons(FILE *out, const fg_decision *decision, fg_verdict verdict) {
  size_t values = 0;
  fg_cures cures = {.count = 0};
  for (size_t i = 0; i < decision->count; i++)
    values += is_listed(&decision->judgements[i], verdict);
  if (!values) return;
  fprintf(out, "<p class=\"reasons\"><b>%s (%zu %s):</b> ", fg_html_verdict_title(verdict), values,
          values == 1 ? "value" : "values");
  put_list(out, decision, verdict);
  fputs(".", out);
  if (verdict == FG_VERDICT_UNDECIDED) fg_cures_add(&cures, decision);
  put_cures(out, &cures);
  fputs("</p>\n", out);
}

void fg_html_defect(FILE *out, const fg_design *design, const fg_foil *foil) {
  char words[200];
  if (fg_foil_defect(design, foil, words, sizeof words))
    fprintf(out, "<p class=\"reasons\"><b>Rejected:</b> %s.</p>\n", words);
}

void fg_html_reason_line(FILE *out, const fg_design *design, const fg_foil *foil,
                         const fg_decision *decision) {
  static const fg_verdict told[] = {FG_VERDICT_FAIL, FG_VERDICT_NOT_MEASURED, FG_VERDICT_UNDECIDED};
  char words[200];
  bool any = false;
  if (foil->error[0]) {
    fg_html_text(out, foil->error);
    any = true;
  }
  if (fg_foil_defect(design, foil, words, sizeof words)) {
    fprintf(out, "%s%s", any ? "; " : "", words);
    any = true;
  }
  for (size_t k = 0; k < sizeof told / sizeof *told; k++) {
    size_t values = 0;
    for (size_t i = 0; i < decision->count; i++)
      values += is_listed(&decision->judgements[i], told[k]);
    if (!values) continue;
    fputs(any ? "; " : "", out);
    if (told[k] != FG_VERDICT_FAIL) fprintf(out, "%s: ", fg_html_verdict_title(told[k]));
    put_list(out, decision, told[k]);
    any = true;
  }
}

/* Writes one line per verdict of the scan's discs that is no pass. */
fg_status fg_html_disc_reasons(fg_context *ctx, FILE *out, const fg_design *design,
                               const fg_measurement *measurement) {
  static const fg_verdict told[] = {FG_VERDICT_FAIL, FG_VERDICT_NOT_MEASURED, FG_VERDICT_UNDECIDED};
  for (size_t k = 0; k < sizeof told / sizeof *told; k++) {
    bool any = false;
    fg_cures cures = {.count = 0};
    for (size_t i = 0; i < measurement->disc_count; i++) {
      fg_decision decision;
      FG_TRY(fg_disc_decide(ctx, design, &measurement->discs[i], &decision));
      for (size_t j = 0; j < decision.count; j++) {
        const fg_judgement *one = &decision.judgements[j];
        if (!is_listed(one, told[k])) continue;
        if (!any) fprintf(out, "<p class=\"reasons\"><b>%s:</b> ", fg_html_verdict_title(told[k]));
        fprintf(out, "%s%s of disc %d", any ? "; " : "", one->row->words, one->number);
        put_judged_number(out, one);
        any = true;
      }
      if (told[k] == FG_VERDICT_UNDECIDED) fg_cures_add(&cures, &decision);
      fg_decision_free(&decision);
    }
    if (any) fputs(".", out);
    put_cures(out, &cures);
    if (any) fputs("</p>\n", out);
  }
  return FG_OK;
}
