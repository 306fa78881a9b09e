/* The loop's report in words: one sentence, and a page for the terminal. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/loop.h"
#include "report/words.h"

/* A number for a sentence or a cell; one that is none is a dash. */
typedef struct number_text {
  char text[32];
} number_text;

static number_text number(const char *format, double value) {
  number_text out;
  if (isfinite(value))
    snprintf(out.text, sizeof out.text, format, value);
  else
    snprintf(out.text, sizeof out.text, "-");
  return out;
}

static void wrong_rows(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                       size_t size) {
  fg_text_clip(text, size, "the responses of rows");
  for (size_t k = 0, count = claim->candidate.rows; k < count; k++) {
    size_t used = strlen(text);
    fg_text_clip(text + used, size - used, "%s %zu%s",
                 k + 1 == count ? " and"
                 : k            ? ","
                                : "",
                 report->problem->row[claim->candidate.row[k]] + 1,
                 k + 1 == count ? " are wrong" : "");
  }
}

static void row_words(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                      size_t size) {
  const size_t *row = report->problem->row;
  size_t first = row[claim->candidate.row[0]] + 1;
  if (report->row_name && claim->candidate.effect->lone == FG_LOOP_EXCHANGED_ROWS)
    fg_text_clip(text, size, "the responses of %s and %s changed places",
                 report->row_name[first - 1], report->row_name[row[claim->candidate.row[1]]]);
  else if (report->row_name)
    fg_text_clip(text, size, "the response of %s is wrong", report->row_name[first - 1]);
  else if (claim->candidate.effect->lone == FG_LOOP_EXCHANGED_ROWS)
    fg_text_clip(text, size, "the responses of rows %zu and %zu changed places", first,
                 report->problem->row[claim->candidate.row[1]] + 1);
  else if (claim->candidate.rows < 2)
    fg_text_clip(text, size, "the response of row %zu is wrong", first);
  else
    wrong_rows(report, claim, text, size);
}

static void claim_words(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                        size_t size) {
  const fg_loop_coordinate *at = report->problem->problem.coordinate;
  const fg_loop_effect *effect = claim->candidate.effect;
  if (!effect->accepts)
    row_words(report, claim, text, size);
  else if (effect->pair)
    fg_text_clip(text, size, "%s %s and %s", effect->words, at[claim->candidate.a].name,
                 at[claim->candidate.b].name);
  else
    fg_text_clip(text, size, "%s %s", effect->words, at[claim->candidate.a].name);
}

const char *fg_loop_noise_form(const fg_loop_result *result) {
  bool serial = false, spread = false;
  for (size_t i = 0; i < result->claims; i++) {
    fg_loop_scatter scatter = result->claim[i].candidate.effect->scatter;
    serial |= scatter == FG_LOOP_SERIAL;
    spread |= scatter == FG_LOOP_SPREAD;
  }
  return serial && spread ? "correlated along the order, of unequal size"
         : serial         ? "correlated along the order"
         : spread         ? "independent, of unequal size"
                          : "independent";
}

static fg_status say_claim(fg_context *ctx, const fg_loop_report *report, size_t i, char **text) {
  const fg_loop_claim *claim = &report->result->claim[i];
  char words[400];
  claim_words(report, claim, words, sizeof words);
  FG_TRY(fg_text_append(ctx, text, "%s%s (amplitude %s ± %s, p = %.2g)", i ? "; and " : "", words,
                        number("%.3g", claim->amplitude).text,
                        number("%.2g", 2 * claim->amplitude_u).text, claim->p_value));
  if (!claim->aliases) return FG_OK;
  FG_TRY(fg_text_append(ctx, text, ", which the data cannot tell from %s", claim->alias[0].name));
  size_t more = claim->aliases + claim->aliases_unlisted - 1;
  if (more) FG_TRY(fg_text_append(ctx, text, " and %zu more", more));
  return FG_OK;
}

static fg_status say_errors(fg_context *ctx, const fg_loop_result *result, char **text) {
  FG_TRY(fg_text_append(ctx, text, ". The error falls from %.3g to %.3g", result->before.rms,
                        result->after.rms));
  if (isfinite(result->ratio_held_out))
    return fg_text_append(ctx, text, "; on data kept aside from %.3g to %.3g.",
                          result->before.held_out_rms, result->after.held_out_rms);
  return fg_text_append(ctx, text, "; each group predicted from the others, from %s to %s.",
                        number("%.3g", result->before.cross_validated_rms).text,
                        number("%.3g", result->after.cross_validated_rms).text);
}

fg_status fg_loop_sentence(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  *text = NULL;
  if (result->verdict == FG_LOOP_CLEAN)
    return fg_text_print(ctx, text,
                         "Nothing is claimed: the residual (%.3g rms) is noise as far as these "
                         "data can tell.",
                         result->before.rms);
  FG_TRY(fg_text_append(ctx, text, "The declared model lacks "));
  for (size_t i = 0; i < result->claims; i++)
    FG_TRY(say_claim(ctx, report, i, text));
  if (result->has_curve)
    FG_TRY(fg_text_append(ctx, text,
                          "%ssomething over %s that no listed effect explains (%.3g rms, p = %.2g)",
                          result->claims ? "; and " : "", result->curve.name, result->curve.rms,
                          result->curve.p_value));
  return say_errors(ctx, result, text);
}

static void write_errors(const fg_loop_result *result, FILE *out) {
  static const char *const names[] = {"rms",     "robust sd",       "95th percentile",
                                      "maximum", "kept aside, rms", "cross-validated, rms"};
  const double before[] = {result->before.rms,          result->before.robust_sd,
                           result->before.p95,          result->before.maximum,
                           result->before.held_out_rms, result->before.cross_validated_rms};
  const double after[] = {result->after.rms,          result->after.robust_sd,
                          result->after.p95,          result->after.maximum,
                          result->after.held_out_rms, result->after.cross_validated_rms};
  fprintf(out, "\n%-24s %12s %12s %8s\n", "error", "before", "after", "ratio");
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (isfinite(before[i]))
      fprintf(out, "%-24s %12.5g %12s %8s\n", names[i], before[i], number("%.5g", after[i]).text,
              number("%.3f", after[i] / before[i]).text);
  fprintf(out, "%-24s %12s %12s\n", "noise floor", "", number("%.5g", result->noise_floor).text);
}

static int by_p(const void *a, const void *b) {
  const fg_loop_rejected *x = *(const fg_loop_rejected *const *)a;
  const fg_loop_rejected *y = *(const fg_loop_rejected *const *)b;
  if (x->p_value != y->p_value) return x->p_value < y->p_value ? -1 : 1;
  return (x > y) - (x < y);
}

static void write_rejected(const fg_loop_result *result, FILE *out) {
  enum { SHOWN = 12 };
  const fg_loop_rejected **list = malloc((result->rejects + 1) * sizeof *list);
  if (!list) return;
  for (size_t i = 0; i < result->rejects; i++)
    list[i] = &result->rejected[i];
  qsort(list, result->rejects, sizeof *list, by_p);
  fprintf(out, "\n%-52s %-20s %7s %9s\n", "not claimed", "verdict", "p", "would show");
  for (size_t i = 0; i < result->rejects && i < SHOWN; i++)
    fprintf(out, "%-52s %-20s %7.2g %9s\n", list[i]->name, fg_loop_verdict_word(list[i]->verdict),
            list[i]->p_value, number("%.3g", list[i]->smallest_detectable).text);
  if (result->rejects > SHOWN) fprintf(out, "and %zu more\n", result->rejects - SHOWN);
  free(list);
}

fg_status fg_loop_write_text(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  char *sentence = NULL;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  fprintf(out, "%s: %s\n%s\n", report->path, fg_loop_outcome_word(result->verdict), sentence);
  free(sentence);
  for (size_t i = 0; i < result->claims; i++) {
    const fg_loop_claim *claim = &result->claim[i];
    fprintf(out, "\n%s: %s\n", claim->name, fg_loop_verdict_word(claim->verdict));
    for (size_t k = 0; k < claim->aliases; k++)
      fprintf(out, "  or %s (correlation %s, loss %s %%)\n", claim->alias[k].name,
              number("%.3f", claim->alias[k].correlation).text,
              number("%.1f", 100 * claim->alias[k].loss).text);
  }
  for (size_t i = 0; i < result->advices; i++)
    fprintf(out, "\n%s\n", result->advice[i].text);
  write_errors(result, out);
  write_rejected(result, out);
  if (report->problem->excluded) fprintf(out, "\nleft out: %s\n", report->problem->excluded);
  if (report->said) fprintf(out, "note: %s\n", report->said);
  for (size_t i = 0; i < result->notes; i++)
    fprintf(out, "note: %s\n", result->note[i]);
  return fg_stream_finish(ctx, out, "the loop's report");
}
