/* The loop's report in words: one sentence, and a page for the terminal. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/loop.h"
#include "report/table_loop/loop_words.h"

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

/* At most this many members of an alias class are named in a sentence. */
enum { ALIASES_SAID = 3 };

static fg_status say_aliases(fg_context *ctx, const fg_loop_report *report,
                             const fg_loop_claim *claim, char **text) {
  size_t said = claim->aliases < ALIASES_SAID ? claim->aliases : ALIASES_SAID;
  size_t more = claim->aliases + claim->aliases_unlisted - said;
  char words[2 * FG_LOOP_WORDS];
  for (size_t k = 0; k < said; k++) {
    fg_loop_alias_words(report, &claim->alias[k], words);
    FG_TRY(fg_text_append(ctx, text, "%s%s",
                          k ? "; " : ", which these data cannot tell from: ", words));
  }
  return more ? fg_text_append(ctx, text, "; and %zu more", more) : FG_OK;
}

/* A sentence of its own: what is of the mean lacks in the model, the rest is a statement. */
static fg_status say_claim(fg_context *ctx, const fg_loop_report *report, size_t i, char **text) {
  const fg_loop_claim *claim = &report->result->claim[i];
  const fg_loop_effect *effect = claim->candidate.effect;
  bool lacks = effect->accepts && effect->scatter == FG_LOOP_OF_THE_MEAN;
  char words[FG_LOOP_WORDS], size[FG_LOOP_NAME];
  fg_loop_claim_words(report, claim, words);
  fg_loop_claim_size(claim, size);
  if (!lacks && *words >= 'a' && *words <= 'z') *words = (char)(*words - 'a' + 'A');
  FG_TRY(fg_text_append(ctx, text, "%s%s%s (%s, p = %.2g)", i ? " " : "",
                        !lacks ? ""
                        : i    ? "The model also lacks "
                               : "The declared model lacks ",
                        words, size, claim->p_value));
  FG_TRY(say_aliases(ctx, report, claim, text));
  return fg_text_append(ctx, text, ".");
}

/* "falls from 3 to 2", "stays at 3": no change that the digits do not show. */
static fg_status say_change(fg_context *ctx, double before, double after, char **text) {
  fg_loop_number first = fg_loop_number_text("%.3g", before);
  fg_loop_number second = fg_loop_number_text("%.3g", after);
  if (!strcmp(first.text, second.text)) return fg_text_append(ctx, text, "stays at %s", first.text);
  return fg_text_append(ctx, text, "%s from %s to %s", after < before ? "falls" : "rises",
                        first.text, second.text);
}

static bool any_scatter(const fg_loop_result *result, fg_loop_scatter scatter) {
  for (size_t i = 0; i < result->claims; i++)
    if (result->claim[i].candidate.effect->scatter == scatter) return true;
  return false;
}

static fg_status say_errors(fg_context *ctx, const fg_loop_result *result, char **text) {
  bool serial = any_scatter(result, FG_LOOP_SERIAL);
  if (!result->has_curve && !serial && !any_scatter(result, FG_LOOP_OF_THE_MEAN))
    return fg_text_append(ctx, text,
                          " No mean changes, so there is no error to take out: limits and "
                          "uncertainties have to follow the scatter.");
  FG_TRY(fg_text_append(ctx, text,
                        serial ? " With each row predicted from the one before it, the error "
                               : " The error "));
  FG_TRY(say_change(ctx, result->before.rms, result->after.rms, text));
  if (isfinite(result->ratio_held_out)) {
    FG_TRY(fg_text_append(ctx, text, "; on rows that took no part in the search it "));
    FG_TRY(say_change(ctx, result->before.held_out_rms, result->after.held_out_rms, text));
  }
  return fg_text_append(ctx, text, ".");
}

/* The first of those looked for in vain that have its words. */
static bool is_first(const fg_loop_result *result, size_t i) {
  const char *words = result->rejected[i].candidate.effect->sought;
  if (!words) return false;
  for (size_t k = 0; k < i; k++) {
    const char *other = result->rejected[k].candidate.effect->sought;
    if (other && !strcmp(other, words)) return false;
  }
  return true;
}

/* What was looked for where nothing was found: only that of which there was a candidate. */
static fg_status say_clean(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  size_t said = 0;
  FG_TRY(fg_text_append(ctx, text,
                        "Nothing is claimed: in %zu rows the residual (%.3g rms) is noise as far "
                        "as these data can tell.",
                        report->problem->problem.rows, result->before.rms));
  for (size_t i = 0; i < result->rejects; i++)
    if (is_first(result, i))
      FG_TRY(fg_text_append(ctx, text, "%s%s", said++ ? ", " : " Looked for: ",
                            result->rejected[i].candidate.effect->sought));
  return said ? fg_text_append(ctx, text, ".") : FG_OK;
}

fg_status fg_loop_sentence(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  *text = NULL;
  if (result->verdict == FG_LOOP_CLEAN) return say_clean(ctx, report, text);
  for (size_t i = 0; i < result->claims; i++)
    FG_TRY(say_claim(ctx, report, i, text));
  if (result->has_curve)
    FG_TRY(fg_text_append(ctx, text,
                          "%s lacks something over %s that no listed effect explains (%.3g rms, "
                          "p = %.2g).",
                          result->claims ? " The model also" : "The declared model",
                          result->curve.name, result->curve.rms, result->curve.p_value));
  return say_errors(ctx, result, text);
}

static void write_errors(const fg_loop_result *result, FILE *out) {
  static const char *const names[] = {"rms",
                                      "robust sd",
                                      "95th percentile",
                                      "maximum",
                                      "rows that took no part, rms",
                                      "cross-validated, rms"};
  const double before[] = {result->before.rms,          result->before.robust_sd,
                           result->before.p95,          result->before.maximum,
                           result->before.held_out_rms, result->before.cross_validated_rms};
  const double after[] = {result->after.rms,          result->after.robust_sd,
                          result->after.p95,          result->after.maximum,
                          result->after.held_out_rms, result->after.cross_validated_rms};
  fprintf(out, "\n%-28s %12s %12s %8s\n", "error", "before", "after", "ratio");
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (isfinite(before[i]))
      fprintf(out, "%-28s %12.5g %12s %8s\n", names[i], before[i],
              fg_loop_number_text("%.5g", after[i]).text,
              fg_loop_number_text("%.3f", after[i] / before[i]).text);
  fprintf(out, "%-28s %12s %12s\n", "noise floor", "",
          fg_loop_number_text("%.5g", result->noise_floor).text);
}

static int by_p(const void *a, const void *b) {
  const fg_loop_rejected *x = *(const fg_loop_rejected *const *)a;
  const fg_loop_rejected *y = *(const fg_loop_rejected *const *)b;
  if (x->p_value != y->p_value) return x->p_value < y->p_value ? -1 : 1;
  return (x > y) - (x < y);
}

static void write_rejected(const fg_loop_report *report, FILE *out) {
  enum { SHOWN = 12 };
  const fg_loop_result *result = report->result;
  char words[FG_LOOP_WORDS];
  const fg_loop_rejected **list = malloc((result->rejects + 1) * sizeof *list);
  if (!list) return;
  for (size_t i = 0; i < result->rejects; i++)
    list[i] = &result->rejected[i];
  qsort(list, result->rejects, sizeof *list, by_p);
  fprintf(out, "\n%-52s %-20s %7s %9s\n", "not claimed", "verdict", "p", "would show");
  for (size_t i = 0; i < result->rejects && i < SHOWN; i++) {
    fg_loop_candidate_words(report, &list[i]->candidate, words);
    fprintf(out, "%-52s %-20s %7s %9s\n", words, fg_loop_rejected_word(list[i]),
            fg_loop_number_text("%.2g", list[i]->p_value).text,
            fg_loop_number_text("%.3g", list[i]->smallest_detectable).text);
  }
  if (result->rejects > SHOWN) fprintf(out, "and %zu more\n", result->rejects - SHOWN);
  free(list);
}

/* What it is first, its id in brackets behind it. */
static void write_claim(const fg_loop_report *report, const fg_loop_claim *claim, FILE *out) {
  char words[2 * FG_LOOP_WORDS];
  fg_loop_claim_words(report, claim, words);
  fprintf(out, "\n%s: %s [%s]\n", words, fg_loop_verdict_word(claim->verdict), claim->name);
  for (size_t k = 0; k < claim->aliases; k++) {
    const fg_loop_alias *alias = &claim->alias[k];
    fg_loop_alias_words(report, alias, words);
    fprintf(out, "  or %s (correlation %s, loss %s %%) [%s]\n", words,
            fg_loop_number_text("%.3f", alias->correlation).text,
            fg_loop_number_text("%.1f", 100 * alias->loss).text, alias->name);
  }
}

fg_status fg_loop_write_text(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  char *sentence = NULL;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  fprintf(out, "%s: %s\n%s\n", report->path, fg_loop_outcome_word(result->verdict), sentence);
  free(sentence);
  for (size_t i = 0; i < result->claims; i++)
    write_claim(report, &result->claim[i], out);
  for (size_t i = 0; i < result->advices; i++)
    fprintf(out, "\n%s\n", result->advice[i].text);
  write_errors(result, out);
  write_rejected(report, out);
  if (report->problem->excluded) fprintf(out, "\nleft out: %s\n", report->problem->excluded);
  if (report->said) fprintf(out, "note: %s\n", report->said);
  for (size_t i = 0; i < result->notes; i++)
    fprintf(out, "note: %s\n", result->note[i]);
  return fg_stream_finish(ctx, out, "the loop's report");
}
