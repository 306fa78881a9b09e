/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects taken out before the analysis, and tests of the residuals over the order of the runs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "report/doe/words.h"
#include "report/value_words.h"

static const char program[] = "foilgauge ";

fg_status fg_experiment_loop_command(fg_context *ctx, const fg_experiment_report *report,
                                     char **command) {
  const fg_experiment *e = report->experiment;
  const struct {
    const char *option, *value;
  } words[] = {
      {report->scans_column ? "--doe" : "--table", report->path},
      {"--scans", report->scans_column},
      {"--design", report->scans_column ? report->design_path : NULL},
      {"--response", e->response},
      {"--model", e->formula},
  };
  *command = NULL;
  FG_TRY(fg_text_append(ctx, command, "%sloop", program));
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    if (!words[i].value) continue;
    FG_TRY(fg_text_append(ctx, command, " %s", words[i].option));
    FG_TRY(fg_text_append_word(ctx, command, words[i].value));
  }
  return FG_OK;
}

static fg_status conclude_subtracted_effect(fg_context *ctx, const fg_subtracted_effect *effect,
                                            fg_sentences *s) {
  char size[80] = "";
  const char *parameters = effect->parameters == 1 ? "parameter" : "parameters";
  if (!effect->applied)
    return fg_sentences_add(ctx, s,
                            "Not taken out: %s, which concerns rows of the table it was found in.",
                            effect->words);
  if (*effect->sentence)
    return fg_sentences_add(
        ctx, s, "Taken out before the analysis: %s (%zu %s), %.3g to %.3g in these runs.",
        effect->sentence, effect->parameters, parameters, effect->low, effect->high);
  fg_scan_loop_value_words(2 * effect->amplitude, 2 * effect->u_amplitude, size, sizeof size);
  return fg_sentences_add(ctx, s,
                          "Taken out before the analysis: %s (from its lowest to its highest %s, "
                          "95 %%; %zu %s), %.3g to %.3g in these runs.",
                          effect->words, size, effect->parameters, parameters, effect->low,
                          effect->high);
}

fg_status fg_experiment_conclude_subtracted(fg_context *ctx, const fg_experiment_report *report,
                                            fg_sentences *s) {
  const fg_experiment *e = report->experiment;
  for (size_t i = 0; i < e->subtracted.count; i++)
    FG_TRY(conclude_subtracted_effect(ctx, &e->subtracted.effects[i], s));
  for (size_t i = 0; i < e->subtracted.count; i++)
    if (fg_experiment_is_of_factors(e, &e->subtracted.effects[i]))
      FG_TRY(fg_sentences_add(ctx, s,
                              "No best setting: %s is of the model's own factors, and the response "
                              "at a setting has it. Declare it in the formula instead, as the "
                              "loop's next step says.",
                              e->subtracted.effects[i].words));
  if (!e->subtracted.dof) return FG_OK;
  if (!e->regression.residual_dof)
    return fg_sentences_add(ctx, s,
                            "%s estimated it from runs like these; this model leaves no degree of "
                            "freedom to subtract for it.",
                            report->model_path ? report->model_path : "The model");
  return fg_sentences_add(
      ctx, s,
      "The estimates of %s cost degrees of freedom: the residual has %zu degree%s of freedom "
      "instead of %zu.",
      report->model_path ? report->model_path : "the model", e->regression.residual_dof,
      fg_plural(e->regression.residual_dof), e->regression.residual_dof + e->subtracted.dof);
}

static fg_status conclude_farthest(fg_context *ctx, const fg_experiment_report *report,
                                   fg_sentences *s) {
  const fg_order_check *o = &report->experiment->order;
  size_t row = report->row ? report->row[o->farthest] : o->farthest + 1;
  char run[300] = "", p_value[16], size[40];
  fg_p_value_text(p_value, o->farthest_p);
  if (o->column) fg_text_clip(run, sizeof run, " (%.200s %g)", o->column, o->value[o->farthest]);
  fg_text_clip(size, sizeof size, "%.3g", fabs(o->farthest_t));
  return fg_sentences_add(ctx, s,
                          "Row %zu%s stands out: it lies %s standard deviations %s what the others "
                          "say of it (p %s%s over all runs). Is it a slip?",
                          row, run, size, o->farthest_t < 0 ? "below" : "above",
                          *p_value == '<' ? "" : "= ", p_value);
}

static fg_status conclude_shown(fg_context *ctx, const fg_experiment_report *report,
                                fg_sentences *s) {
  const fg_order_check *o = &report->experiment->order;
  char p_value[16];
  if (fg_order_shows(o->drift_p)) {
    fg_p_value_text(p_value, o->drift_p);
    FG_TRY(fg_sentences_add(ctx, s,
                            "The response drifts over the order of the runs: from the first to the "
                            "last it %s by %.3g ± %.2g beside the model (p %s%s).",
                            o->drift < 0 ? "falls" : "rises", fabs(o->drift), 2 * o->u_drift,
                            *p_value == '<' ? "" : "= ", p_value));
  }
  if (fg_order_shows(o->neighbours_p))
    FG_TRY(fg_sentences_add(
        ctx, s,
        "Serial correlation: successive runs %s; their residuals are correlated by %.2f "
        "(Durbin-Watson %.2f, p = %.3f), so the standard errors above are too "
        "%s.",
        o->neighbours > 0 ? "resemble each other" : "alternate", o->neighbours, o->durbin_watson,
        o->neighbours_p, o->neighbours > 0 ? "small" : "uncertain"));
  if (fg_order_shows(o->farthest_p)) FG_TRY(conclude_farthest(ctx, report, s));
  return FG_OK;
}

static fg_status conclude_nothing_shows(fg_context *ctx, const fg_order_check *o, fg_sentences *s) {
  char text[200] = "";
  const struct {
    const char *words;
    double p_value;
  } tests[] = {{"no drift", o->drift_p},
               {"no serial correlation", o->neighbours_p},
               {"no run that stands out", o->farthest_p}};
  for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
    size_t used = strlen(text);
    if (isfinite(tests[i].p_value))
      fg_text_clip(text + used, sizeof text - used, "%s%s (p = %.2f)", used ? ", " : "",
                   tests[i].words, tests[i].p_value);
  }
  if (!*text) return FG_OK;
  return fg_sentences_add(ctx, s, "Over the order of the runs (%s) the residuals show %s.",
                          o->column ? o->column : "the rows of the table", text);
}

fg_status fg_experiment_conclude_order(fg_context *ctx, const fg_experiment_report *report,
                                       fg_sentences *s) {
  const fg_order_check *o = &report->experiment->order;
  char *command = NULL;
  if (!report->experiment->has_order) return FG_OK;
  if (!fg_order_seen(o)) return conclude_nothing_shows(ctx, o, s);
  FG_TRY(conclude_shown(ctx, report, s));
  FG_TRY(fg_sentences_add(
      ctx, s, "The loop on tables tells what that is, and what it does to the result:"));
  FG_TRY(fg_experiment_loop_command(ctx, report, &command));
  fg_status status = fg_sentences_add(ctx, s, "%s", command);
  free(command);
  return status;
}

bool fg_sentence_is_command(const char *text) {
  return !strncmp(text, program, sizeof program - 1);
}
