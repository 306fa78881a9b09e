/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop's report in words: one sentence, and a page for the terminal. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "report/table_loop/checks.h"
#include "report/table_loop/claim_members.h"
#include "report/table_loop/influence_members.h"
#include "report/table_loop/next.h"
#include "report/table_loop/reading.h"
#include "report/table_loop/scale_members.h"
#include "report/table_loop/suspect_members.h"
#include "report/table_loop/words.h"
#include "report/unit_words.h"
#include "report/value_words.h"

const char *fg_loop_noise_model(const fg_loop_result *result) {
  bool serial = fg_loop_claims_scatter(result, FG_LOOP_SERIAL);
  bool spread = fg_loop_claims_scatter(result, FG_LOOP_SPREAD);
  bool levels = fg_loop_claims_scatter(result, FG_LOOP_LEVELS);
  if (levels)
    return spread ? "sharing levels, of unequal size" : "independent within levels that scatter";
  return serial && spread ? "correlated along the order, of unequal size"
         : serial         ? "correlated along the order"
         : spread         ? "independent, of unequal size"
                          : "independent";
}

/* Maximum number of members of an alias class in a sentence. */
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

/* Appends a claim as a sentence: an effect of the mean is missing in the model, any other is a
 * statement. */
static fg_status append_claim(fg_context *ctx, const fg_loop_report *report, size_t i,
                              char **text) {
  const fg_loop_claim *claim = &report->result->claim[i];
  const fg_loop_effect *effect = claim->candidate.effect;
  bool lacks = effect->accepts && effect->scatter == FG_LOOP_OF_THE_MEAN;
  char words[2 * FG_LOOP_WORDS];
  fg_loop_claim_sentence(report, claim, words);
  if (!lacks && *words >= 'a' && *words <= 'z') *words = (char)(*words - 'a' + 'A');
  FG_TRY(fg_text_append(ctx, text, "%s%s%s (%s)", i ? " " : "",
                        !lacks ? ""
                        : i    ? "The model also lacks "
                               : "The declared model lacks ",
                        words, fg_loop_p_text(claim->p_value).text));
  FG_TRY(say_aliases(ctx, report, claim, text));
  return fg_text_append(ctx, text, ".");
}

/* "falls from 3 to 2 µm", "stays at 3 µm": no change that the digits do not show. */
static fg_status write_change(fg_context *ctx, double before, double after, const char *unit,
                              char **text) {
  const char *blank = *unit && strcmp(unit, "°") != 0 ? " " : "";
  fg_loop_number first = fg_loop_number_text("%.3g", before);
  fg_loop_number second = fg_loop_number_text("%.3g", after);
  if (!strcmp(first.text, second.text))
    return fg_text_append(ctx, text, "stays at %s%s%s", first.text, blank, unit);
  return fg_text_append(ctx, text, "%s from %s to %s%s%s", after < before ? "falls" : "rises",
                        first.text, second.text, blank, unit);
}

static fg_status write_errors_before_after(fg_context *ctx, const fg_loop_report *report,
                                           char **text) {
  const fg_loop_result *result = report->result;
  const char *unit = fg_unit_of_name(report->spec->response);
  bool serial = fg_loop_claims_scatter(result, FG_LOOP_SERIAL);
  if (!fg_loop_has_after(result))
    return fg_text_append(ctx, text,
                          " No mean changes, so there is no error to take out: limits and "
                          "uncertainties have to follow the scatter.");
  FG_TRY(fg_text_append(ctx, text,
                        serial ? " With each row predicted from the one before it, the error "
                               : " The error "));
  FG_TRY(write_change(ctx, result->before.rms, result->after.rms, unit, text));
  if (isfinite(result->ratio_held_out)) {
    FG_TRY(fg_text_append(ctx, text, "; on rows that took no part in the search it "));
    FG_TRY(write_change(ctx, result->before.held_out_rms, result->after.held_out_rms, unit, text));
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

/* Appends whether all is noise, or a residual test nearly fails. */
static fg_status append_noise(fg_context *ctx, const fg_loop_report *report, char **text) {
  fg_loop_check check;
  char words[FG_LOOP_WORDS];
  if (fg_loop_suspects_residual(report->result, &check)) {
    fg_loop_check_words(report, check, words);
    return fg_text_append(ctx, text, "may not be noise alone. Not sure: %s (%s)", words,
                          fg_loop_p_text(report->result->check[check].p_value).text);
  }
  if (!report->result->far_row.rows)
    return fg_text_append(ctx, text, "is noise as far as these data can tell.");
  fg_loop_rows_words(report, &report->result->far_row, words);
  return fg_text_append(ctx, text,
                        "is noise as far as these data can tell, but %s lies farther out than "
                        "normal noise reaches: a wrong value, or a scatter with heavy tails.",
                        words);
}

/* Appends how many of the effects looked for would have shown at the size that matters. */
static fg_status append_shown(fg_context *ctx, const fg_loop_result *result, char **text) {
  size_t absent = 0, open = 0;
  for (size_t i = 0; i < result->rejects; i++) {
    absent += result->rejected[i].verdict == FG_LOOP_ABSENT;
    open += result->rejected[i].verdict == FG_LOOP_INCONCLUSIVE;
  }
  if (!absent && !open) return FG_OK;
  return fg_text_append(ctx, text,
                        " At the size that matters %zu of %zu effects would have shown%s.", absent,
                        absent + open, open ? "; the others only when larger (see the table)" : "");
}

/* Appends the effects sought without success, of which there was a candidate. */
static fg_status append_clean(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  const char *unit = fg_unit_of_name(report->spec->response);
  size_t said = 0;
  FG_TRY(fg_text_append(ctx, text, "Nothing is claimed: in %zu rows the residual (%.3g%s%s rms) ",
                        report->problem->problem.rows, result->before.rms, *unit ? " " : "", unit));
  FG_TRY(append_noise(ctx, report, text));
  for (size_t i = 0; i < result->rejects; i++)
    if (is_first(result, i))
      FG_TRY(fg_text_append(ctx, text, "%s%s", said++ ? ", " : " Looked for: ",
                            result->rejected[i].candidate.effect->sought));
  bool repeats = result->check[FG_LOOP_CHECK_REPEATS].done;
  if (said && (repeats || result->check[FG_LOOP_CHECK_SETTINGS].done))
    FG_TRY(fg_text_append(ctx, text, ", lack of fit where settings repeat"));
  if (said && result->check[FG_LOOP_CHECK_LAGS].done)
    FG_TRY(fg_text_append(ctx, text, ", rows further apart that are alike"));
  if (said) FG_TRY(fg_text_append(ctx, text, "."));
  return append_shown(ctx, result, text);
}

/* Appends the finding of the failed residual test. */
static fg_status append_failed(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  char words[FG_LOOP_WORDS];
  fg_loop_failed_words(report, words);
  if (result->claims || result->has_curve)
    return fg_text_append(ctx, text, " What is left is not noise alone: %s.", words);
  return fg_text_append(ctx, text,
                        "The declared model lacks something that no listed effect explains: %s. "
                        "Nothing is taken out: the error stays at %.3g rms.",
                        words, result->before.rms);
}

fg_status fg_loop_sentence(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  *text = NULL;
  if (result->verdict == FG_LOOP_CLEAN) return append_clean(ctx, report, text);
  if (result->verdict == FG_LOOP_SUSPECTED) return fg_loop_append_suspects(ctx, report, text);
  for (size_t i = 0; i < result->claims; i++)
    FG_TRY(append_claim(ctx, report, i, text));
  if (result->has_curve)
    FG_TRY(fg_text_append(ctx, text,
                          "%s lacks something over %s that no listed effect explains (%.3g rms, "
                          "%s).",
                          result->claims ? " The model also" : "The declared model",
                          result->curve.name, result->curve.rms,
                          fg_loop_p_text(result->curve.p_value).text));
  if (result->fails) FG_TRY(append_failed(ctx, report, text));
  bool nothing = !result->claims && !result->has_curve;
  return nothing ? FG_OK : write_errors_before_after(ctx, report, text);
}

static void write_errors(const fg_loop_report *report, FILE *out) {
  fg_loop_error_row row[FG_LOOP_ERROR_ROWS + 1];
  size_t rows = fg_loop_error_rows(report, row);
  double floor = report->result->noise_floor;
  row[rows] = (fg_loop_error_row){"noise of one row (sd)",
                                  fg_loop_has_after(report->result) ? NAN : floor, floor};
  fputc('\n', out);
  fg_members_terminal(out, "", &fg_loop_error_row_members, &(fg_subject){row, report, rows + 1},
                      fg_loop_find_error);
}

static void write_residual_tests(const fg_loop_report *report, FILE *out) {
  char words[FG_LOOP_WORDS];
  bool any = false;
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++) {
    const fg_loop_checked *check = &report->result->check[k];
    if (!check->done) continue;
    if (!any) fputs("\nis what is left only noise?\n", out);
    any = true;
    fg_loop_check_words(report, (fg_loop_check)k, words);
    fprintf(out, "  %-8s %s (%s)\n", check->failed ? "NO" : fg_loop_check_answer(check), words,
            fg_loop_p_text(check->p_value).text);
  }
}

static void write_next(const fg_loop_report *report, FILE *out) {
  char step[FG_LOOP_STEP];
  fputs("\nwhat to do next\n", out);
  for (size_t i = 0; i < fg_loop_next_count(report); i++) {
    fg_loop_next_step(report, i, step);
    fg_write_wrapped(out, "  - ", "    ", step);
  }
}

static int by_rejected_p(const void *a, const void *b) {
  const fg_loop_rejected *x = *(const fg_loop_rejected *const *)a;
  const fg_loop_rejected *y = *(const fg_loop_rejected *const *)b;
  if (x->p_value != y->p_value) return x->p_value < y->p_value ? -1 : 1;
  return (x > y) - (x < y);
}

/* Finds an element of the sorted list, of `index` elements. */
static bool find_sorted_rejected(const fg_subject *list, size_t i, fg_subject *element) {
  if (i < list->index) element->object = ((const fg_loop_rejected *const *)list->object)[i];
  return i < list->index;
}

static void print_rejected(const fg_loop_report *report, FILE *out) {
  enum { SHOWN = 12 };
  const fg_loop_result *result = report->result;
  const fg_loop_rejected **list = malloc((result->rejects + 1) * sizeof *list);
  if (!list) return;
  for (size_t i = 0; i < result->rejects; i++)
    list[i] = &result->rejected[i];
  fg_sort_items(list, result->rejects, sizeof *list, by_rejected_p);
  size_t shown = result->rejects < SHOWN ? result->rejects : SHOWN;
  fputc('\n', out);
  fg_members_terminal(out, "", &fg_loop_rejected_members, &(fg_subject){list, report, shown},
                      find_sorted_rejected);
  if (result->rejects > SHOWN) fprintf(out, "and %zu more\n", result->rejects - SHOWN);
  free(list);
}

/* Writes a claim in words, its id in brackets. */
static void print_claim(const fg_loop_report *report, const fg_loop_claim *claim, FILE *out) {
  char words[2 * FG_LOOP_WORDS], closeness[FG_LOOP_WORDS];
  fg_loop_claim_words(report, claim, words);
  fprintf(out, "  %s: %s [%s]\n", words, fg_loop_verdict_word(claim->verdict), claim->name);
  fg_loop_claim_size(report, claim, words);
  fg_write_wrapped(out, "    ", "    ", words);
  for (size_t k = 0; k < claim->aliases; k++) {
    const fg_loop_alias *alias = &claim->alias[k];
    fg_loop_alias_words(report, alias, words);
    fg_loop_closeness_words(alias, closeness);
    fprintf(out, "    or %s%s%s%s [%s]\n", words, *closeness ? " (" : "", closeness,
            *closeness ? ")" : "", alias->name);
  }
}

static void write_notes(const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  if (!report->problem->excluded && !report->said && !result->notes && !result->influences &&
      !fg_loop_tells_scale(result))
    return;
  fputc('\n', out);
  if (report->said) fg_write_wrapped(out, "note: ", "      ", report->said);
  if (fg_loop_tells_scale(result)) {
    char words[FG_LOOP_WORDS];
    fg_loop_scale_words(report, words);
    fg_write_wrapped(out, "note: ", "      ", words);
  }
  for (size_t i = 0; i < result->influences; i++) {
    char words[FG_LOOP_WORDS];
    fg_loop_influence_words(report, &result->influence[i], words);
    fg_write_wrapped(out, "influence: ", "      ", words);
  }
  for (size_t i = 0; i < result->notes; i++)
    fg_write_wrapped(out, "note: ", "      ", result->note[i]);
  if (report->problem->excluded)
    fg_write_wrapped(out, "no candidates: ", "      ", report->problem->excluded);
}

fg_status fg_loop_write_text(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  char *sentence = NULL;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  fprintf(out, "%s: %s\n", report->path, fg_loop_outcome_word(result->verdict));
  fg_loop_check check;
  if (result->verdict != FG_LOOP_CLEAN || fg_loop_suspects_residual(result, &check))
    fprintf(out, "%s\n", fg_loop_outcome_meaning(result));
  fputc('\n', out);
  fg_write_wrapped(out, "", "", sentence);
  free(sentence);
  write_next(report, out);
  if (result->suspects) {
    fputc('\n', out);
    fg_members_terminal(out, "", &fg_loop_suspect_members, &(fg_subject){report, report, 0},
                        fg_loop_find_suspect);
  }
  if (result->claims) fputs("\nwhat was found\n", out);
  for (size_t i = 0; i < result->claims; i++)
    print_claim(report, &result->claim[i], out);
  write_errors(report, out);
  write_residual_tests(report, out);
  print_rejected(report, out);
  write_notes(report, out);
  return fg_stream_finish(ctx, out, "the loop's report");
}
