/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/doe/words.h"
#include "foilgauge/design.h"
#include "foilgauge/report.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "report/unit_words.h"

const char *fg_surface_kind_word(fg_surface_kind kind) {
  switch (kind) {
  case FG_SURFACE_MINIMUM:
    return "minimum";
  case FG_SURFACE_MAXIMUM:
    return "maximum";
  case FG_SURFACE_SADDLE:
    return "saddle";
  case FG_SURFACE_RIDGE:
    return "ridge";
  case FG_SURFACE_PLANE:
    return "plane";
  }
  return "";
}

const char *fg_goal_word(fg_goal goal) {
  return goal == FG_GOAL_LOWEST ? "lowest" : goal == FG_GOAL_HIGHEST ? "highest" : "target";
}

void fg_p_value_text(char text[16], double p_value) {
  if (!isfinite(p_value))
    strcpy(text, "–");
  else if (p_value < 0.0001)
    strcpy(text, "< 0.0001");
  else
    snprintf(text, 16, "%.4f", p_value);
}

fg_status fg_experiment_response_words(fg_context *ctx, const fg_experiment *e, char **words) {
  if (!e->magnitude) return fg_text_print(ctx, words, "%s as it is", e->response);
  return fg_text_print(ctx, words, "the magnitude of %s%s", e->response,
                       e->sign_chosen ? " (as in the thesis; --sign as-is keeps the sign)" : "");
}

fg_status fg_sentences_add(fg_context *ctx, fg_sentences *s, const char *format, ...) {
  char text[4096];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  FG_TRY(fg_memory_reserve(ctx, s->count + 1, sizeof *s->text, &s->capacity, (void **)&s->text));
  s->text[s->count] = NULL;
  FG_TRY(fg_text_print(ctx, &s->text[s->count], "%s", text));
  s->count++;
  return FG_OK;
}

void fg_sentences_free(fg_sentences *s) {
  for (size_t i = 0; i < s->count; i++)
    free(s->text[i]);
  free(s->text);
  *s = (fg_sentences){0};
}

static bool interacts(const fg_experiment *e, size_t variable, size_t other) {
  for (size_t t = 0; t < e->model.formula.terms; t++)
    if (e->model.formula.term[t].power[variable] && e->model.formula.term[t].power[other])
      return true;
  return false;
}

void fg_experiment_reference_words(const fg_experiment *e, size_t variable, char *text,
                                   size_t size) {
  *text = '\0';
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    size_t used = strlen(text);
    if (!e->model.levels[v].count || v == e->block_variable || !interacts(e, variable, v)) continue;
    fg_text_clip(text + used, size - used, "%s %s %s", used ? "," : " (at",
                 e->model.formula.variable[v].name, e->model.levels[v].name[0]);
  }
  size_t used = strlen(text);
  if (used) fg_text_clip(text + used, size - used, ")");
}

static fg_status conclude_effect(fg_context *ctx, const fg_experiment *e, size_t j,
                                 fg_sentences *s) {
  const fg_coefficient *c = &e->regression.coefficient[j];
  const fg_experiment_effect *effect = &e->effect[j];
  const fg_factor *factor = fg_experiment_main_factor(e, j);
  char p_value[16], interval[200] = "", by[80], min[80], max[80], name[300], from[80], to[80],
                    reference[300];
  double change = 2 * c->estimate, low = 2 * effect->low, high = 2 * effect->high;
  fg_p_value_text(p_value, fg_experiment_p_value(e, j));
  const char *equals = *p_value == '<' ? "" : "= ";
  if (isfinite(effect->low)) {
    fg_value_with_unit(e->response, change < 0 ? -high : low, 3, min, sizeof min);
    fg_value_with_unit(e->response, change < 0 ? -low : high, 3, max, sizeof max);
    fg_text_clip(interval, sizeof interval, ", %g %% interval %s to %s", 100 * e->confidence, min,
                 max);
  }
  if (factor) {
    fg_name_words(factor->name, name, sizeof name);
    fg_value_with_unit(factor->name, fg_factor_real(factor, -1), 6, from, sizeof from);
    fg_value_with_unit(factor->name, fg_factor_real(factor, 1), 6, to, sizeof to);
    fg_value_with_unit(e->response, fabs(change), 3, by, sizeof by);
    fg_experiment_reference_words(e, factor->variable, reference, sizeof reference);
    return fg_sentences_add(
        ctx, s, "%s matters%s: from %s to %s it %s the response by %s%s (p %s%s).", name, reference,
        from, to, change < 0 ? "lowers" : "raises", by, interval, equals, p_value);
  }
  return fg_sentences_add(ctx, s, "%s matters: coefficient %.4g (p %s%s).", c->name, c->estimate,
                          equals, p_value);
}

static fg_status conclude_effects(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  size_t found = 0, judged = 0, told = 0;
  char rest[600] = "", reference[300];
  for (size_t j = 0; j < e->regression.columns; j++) {
    if (!fg_experiment_of_interest(e, j)) continue;
    told++;
    if (!isfinite(fg_experiment_p_value(e, j))) continue;
    judged++;
    if (fg_experiment_p_value(e, j) < 1 - e->confidence) {
      found++;
      FG_TRY(conclude_effect(ctx, e, j, s));
    } else {
      const fg_factor *factor = fg_experiment_main_factor(e, j);
      size_t used = strlen(rest);
      *reference = '\0';
      if (factor) fg_experiment_reference_words(e, factor->variable, reference, sizeof reference);
      fg_text_clip(rest + used, sizeof rest - used, "%s%s%s", used ? ", " : "",
                   e->regression.coefficient[j].name, reference);
    }
  }
  if (!told)
    return fg_sentences_add(
        ctx, s,
        "No effect can be judged: none can be told apart from the blocks or from others. Change "
        "the factors within blocks, and each without the others.");
  if (!judged)
    return fg_sentences_add(
        ctx, s,
        "No effect can be judged: there is no error to compare it with. Repeat runs "
        "or leave terms out.");
  if (!found)
    return fg_sentences_add(ctx, s, "No effect can be told from the scatter at %g %%: %s.",
                            100 * e->confidence, rest);
  if (*rest)
    return fg_sentences_add(ctx, s, "Not told from the scatter at %g %%: %s.", 100 * e->confidence,
                            rest);
  return FG_OK;
}

static fg_status conclude_quality(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  const fg_regression *r = &e->regression;
  if (!r->residual_dof) return FG_OK;
  FG_TRY(fg_sentences_add(
      ctx, s,
      "The model explains %.0f %% of the variation (adjusted %.0f %%) and would predict "
      "%.0f %% of it in runs that it has not seen. The runs scatter about it with a standard "
      "deviation of %.3g (%zu degree%s of freedom).",
      100 * r->r2, 100 * r->adjusted_r2, 100 * fmax(0, r->predicted_r2), r->residual_sd,
      r->residual_dof, fg_plural(r->residual_dof)));
  if (e->has_split_plot && isfinite(e->split_plot.plot_variance))
    FG_TRY(fg_sentences_add(
        ctx, s,
        "Of this scatter, whole plots differ by a standard deviation of %.3g, runs within "
        "them by %.3g.",
        sqrt(e->split_plot.plot_variance), sqrt(e->split_plot.run_variance)));
  if (fg_experiment_lacks_fit(e)) {
    if (!fg_experiment_best(e)->best.found) FG_TRY(fg_experiment_conclude_lack(ctx, e, s));
  } else if (r->pure_dof && r->lack_dof && isfinite(r->lack_p_value) && !e->has_split_plot)
    FG_TRY(fg_sentences_add(ctx, s,
                            "No lack of fit shows beside the scatter of repeated runs (p = %.4f).",
                            r->lack_p_value));
  if (e->has_box_cox && (e->box_cox.low > 1 || e->box_cox.high < 1))
    FG_TRY(fg_sentences_add(
        ctx, s,
        "A power of the response would suit the model better: lambda %.2g (%.2g to %.2g); "
        "0 is the logarithm.",
        e->box_cox.lambda, e->box_cox.low, e->box_cox.high));
  return FG_OK;
}

/* True where the model holds the square of a factor. */
static bool has_squares(const fg_experiment *e) {
  for (size_t j = 0; j < e->regression.columns; j++) {
    const fg_model_column *c = &e->model.column[j];
    if (c->parts == 1 && c->part[0].level == FG_PART_NUMBER && c->part[0].power == 2) return true;
  }
  return false;
}

/* Curvature at the centre is of no known factor: squares in the model show which, or need
 * further runs first. */
static fg_status conclude_curvature(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  char p_value[16];
  if (!e->has_curvature || !isfinite(e->curvature.p_value)) return FG_OK;
  fg_p_value_text(p_value, e->curvature.p_value);
  if (e->curvature.p_value < 1 - e->confidence)
    return fg_sentences_add(
        ctx, s,
        "The centre runs lie off the plane of the corners (p %s%s): the response is curved; %s.",
        *p_value == '<' ? "" : "= ", p_value,
        has_squares(e)            ? "the squares of the model say in which factor"
        : e->curvature.others > 0 ? "the plan has runs beyond corners and centre: squares in the "
                                    "model (x^2) tell in which factor"
                                  : "axial runs would tell in which factor");
  return fg_sentences_add(ctx, s, "The centre runs show no curvature (p = %.4f).",
                          e->curvature.p_value);
}

static fg_status conclude_measurement(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  double sd = e->regression.residual_sd;
  if (!e->measurement.u || e->measurement.weight || !e->regression.residual_dof || !(sd > 0))
    return FG_OK;
  return fg_sentences_add(
      ctx, s,
      "Measurement: standard uncertainty %.3g, %.2g %% of the variance between runs; the "
      "rest is the process.",
      e->measurement.u_rms,
      fmin(100, 100 * e->measurement.u_rms * e->measurement.u_rms / (sd * sd)));
}

/* The error that all scans share is in no run's u. */
static fg_status conclude_calibration(fg_context *ctx, const fg_experiment_report *report,
                                      fg_sentences *s) {
  if (!report->scans || !report->design) return FG_OK;
  if (!report->design->calibration.stated)
    return fg_sentences_add(
        ctx, s,
        "No calibration is stated: u of the runs holds statistics only, and the "
        "scanner's scale is taken for right.");
  if (!(report->u_calibration > 0)) return FG_OK;
  return fg_sentences_add(
      ctx, s,
      "Calibration: its error is the same in every scan, so it is in no run's u and in no effect's "
      "interval; it moves the level of all runs by up to %.2g (U = 2 u).",
      FG_COVERAGE_FACTOR * report->u_calibration);
}

fg_status fg_experiment_conclusions(fg_context *ctx, const fg_experiment_report *report,
                                    fg_sentences *s) {
  const fg_experiment *e = report->experiment;
  *s = (fg_sentences){0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_experiment_conclude_subtracted(ctx, report, s));
  FG_TRY_EXIT(fg_experiment_conclude_best(ctx, e, s));
  FG_TRY_EXIT(fg_experiment_conclude_asked(ctx, e, s));
  FG_TRY_EXIT(fg_experiment_conclude_blocks(ctx, e, s));
  FG_TRY_EXIT(conclude_effects(ctx, e, s));
  FG_TRY_EXIT(conclude_quality(ctx, e, s));
  FG_TRY_EXIT(conclude_curvature(ctx, e, s));
  FG_TRY_EXIT(conclude_measurement(ctx, e, s));
  FG_TRY_EXIT(conclude_calibration(ctx, report, s));
  FG_TRY_EXIT(fg_experiment_conclude_order(ctx, report, s));
  FG_TRY_EXIT(fg_experiment_conclude_stationary(ctx, e, s));
exit:
  if (status != FG_OK) fg_sentences_free(s);
  return status;
}
