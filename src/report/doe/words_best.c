/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conclusions on the best setting: its place, its response, and the trust in it. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/doe/words.h"
#include "report/unit_words.h"

static const fg_idle_factor *idle_of(const fg_experiment *e, size_t variable) {
  for (size_t i = 0; i < e->idle.count; i++)
    if (e->idle.factor[i].variable == variable) return &e->idle.factor[i];
  return NULL;
}

/* The factor of the experiment that holds the variable, or NULL: it is of words. */
static const fg_factor *find_variable_factor(const fg_experiment *e, size_t variable) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == variable) return &e->factor[f];
  return NULL;
}

/* The experiment's variable of that column; model.formula.variables: none. */
static size_t variable_of(const fg_experiment *e, const char *column) {
  size_t v = 0;
  while (v < e->model.formula.variables && strcmp(e->model.formula.variable[v].column, column) != 0)
    v++;
  return v;
}

/* "temperature 600 °C", "die B", or nothing: the variable has no place in the best setting. */
static void put_variable(const fg_experiment *best, const double *x, const char *column, char *text,
                         size_t size) {
  size_t v = variable_of(best, column);
  char name[300], value[80];
  *text = '\0';
  if (v == best->model.formula.variables || v == best->block_variable) return;
  for (size_t k = 0; k < best->surface.factors; k++) {
    if (best->surface.variable[k] != v) continue;
    fg_name_words(column, name, sizeof name);
    fg_value_with_unit(column, fg_factor_real(find_variable_factor(best, v), x[k]), 5, value,
                       sizeof value);
    fg_text_clip(text, size, "%s %s", name, value);
    return;
  }
  if (best->model.levels[v].count)
    fg_text_clip(text, size, "%s %s", best->model.formula.variable[v].name,
                 best->model.levels[v].name[(size_t)best->best.levels[v]]);
}

/* True where a constraint involves the factor: then not every setting is allowed. */
static bool is_constrained(const fg_experiment *e, size_t variable) {
  for (size_t k = 0; k < e->surface.factors; k++)
    for (size_t p = 0; p < e->region.planes; p++)
      if (e->surface.variable[k] == variable && e->region.normal[p][k] != 0) return true;
  return false;
}

static void put_setting(const fg_experiment *e, const double *x, bool with_idle, char *text,
                        size_t size) {
  const fg_experiment *best = fg_experiment_best(e);
  text[0] = '\0';
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    const char *column = e->model.formula.variable[v].column;
    char one[400] = "", name[300];
    if (idle_of(e, v) && (e->reduced || e->idle.all) && with_idle) {
      fg_name_words(column, name, sizeof name);
      fg_text_clip(one, sizeof one, "%s any%s (cheapest will do)", name,
                   is_constrained(e, v) ? " that the constraints allow" : "");
    } else {
      put_variable(best, x, column, one, sizeof one);
    }
    size_t used = strlen(text);
    if (*one) fg_text_clip(text + used, size - used, "%s%s", used ? ", " : "", one);
  }
}

void fg_experiment_setting_words(const fg_experiment *e, const double *x, char *text, size_t size) {
  put_setting(e, x, true, text, size);
}

fg_status fg_experiment_conclude_stationary(fg_context *ctx, const fg_experiment *e,
                                            fg_sentences *s) {
  const fg_experiment *best = fg_experiment_best(e);
  char setting[700], value[80];
  if (!best->best.found || !best->surface.has_stationary || e->idle.all) return FG_OK;
  put_setting(e, best->surface.stationary, false, setting, sizeof setting);
  fg_value_with_unit(e->response, best->surface.stationary_value, 4, value, sizeof value);
  return fg_sentences_add(ctx, s, "The surface is stationary at %s: a %s of %s, %s the region.",
                          setting, fg_surface_kind_word(best->surface.kind), value,
                          best->stationary_inside ? "inside" : "outside");
}

/* "Expected response 3.45 (95 % interval ...); one confirmation run should fall between ...". */
static fg_status conclude_expected(fg_context *ctx, const fg_experiment *e, const char *what,
                                   const char *setting, const fg_prediction *p, fg_sentences *s) {
  const double numbers[5] = {p->mean, p->low, p->high, p->run_low, p->run_high};
  char n[5][80];
  for (int i = 0; i < 5; i++)
    fg_value_with_unit(e->response, numbers[i], i ? 3 : 4, n[i], sizeof n[i]);
  if (!isfinite(p->low))
    return fg_sentences_add(ctx, s, "%s (%s): %s. Expected response %s.", what,
                            fg_goal_word(e->best.goal), setting, n[0]);
  return fg_sentences_add(
      ctx, s,
      "%s (%s): %s. Expected response %s (%g %% interval %s to %s); one confirmation run "
      "should fall between %s and %s.",
      what, fg_goal_word(e->best.goal), setting, n[0], 100 * e->confidence, n[1], n[2], n[3], n[4]);
}

static fg_status conclude_rounded(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  const fg_experiment *best = fg_experiment_best(e);
  char setting[700], what[700] = "Best setting that can be made, in steps of ";
  const char *separator = "";
  if (!best->best.has_rounded) return FG_OK;
  for (size_t k = 0; k < best->surface.factors; k++) {
    char step[80];
    size_t used = strlen(what);
    if (!(best->best.step[k] > 0)) continue;
    fg_value_with_unit(fg_surface_factor(best, k)->name, best->best.step[k], 5, step, sizeof step);
    fg_text_clip(what + used, sizeof what - used, "%s%s", separator, step);
    separator = " and ";
  }
  put_setting(e, best->best.rounded.x, true, setting, sizeof setting);
  return conclude_expected(ctx, e, what, setting, &best->best.rounded.prediction, s);
}

/* The best setting of the model as given, with the factors that are only noise. */
static fg_status conclude_as_given(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  const fg_optimum *best = fg_experiment_best_point(e);
  char setting[700] = "", value[80];
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    char one[400];
    size_t used = strlen(setting);
    put_variable(e, best->x, e->model.formula.variable[v].column, one, sizeof one);
    if (*one) fg_text_clip(setting + used, sizeof setting - used, "%s%s", used ? ", " : "", one);
  }
  fg_value_with_unit(e->response, best->prediction.mean, 4, value, sizeof value);
  return fg_sentences_add(ctx, s,
                          "The model as given, scatter and all, would lead to %s (%s): a setting "
                          "to test, not a finding.",
                          setting, value);
}

static fg_status conclude_no_best(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  char setting[700], p_value[40] = "";
  if (isfinite(e->regression.model_p_value))
    fg_text_clip(p_value, sizeof p_value, " (all together: p = %.3f)", e->regression.model_p_value);
  put_setting(e, NULL, true, setting, sizeof setting);
  FG_TRY(fg_sentences_add(
      ctx, s, "No best setting (%s): %s. No factor can be told from the scatter at %g %%%s.",
      fg_goal_word(e->best.goal), setting, 100 * e->confidence, p_value));
  return conclude_as_given(ctx, e, s);
}

/* Adds the size that may hide behind "any": "temperature cannot be told from the scatter ...,
 * from 500 °C to 600 °C it changes the response by 0.2 µm, 95 % interval −1.1 µm to 1.5 µm". */
static fg_status conclude_idle(fg_context *ctx, const fg_experiment *e, const fg_idle_factor *idle,
                               fg_sentences *s) {
  const char *column = e->model.formula.variable[idle->variable].column;
  char name[300], p_value[60] = "", p[16], change[700] = "", n[5][80], reference[300];
  fg_name_words(column, name, sizeof name);
  fg_p_value_text(p, idle->p_value);
  if (isfinite(idle->p_value))
    fg_text_clip(p_value, sizeof p_value, " (p = %s%s)", p,
                 idle->columns > 1 ? ", its terms together" : "");
  for (size_t j = 0; j < e->regression.columns; j++) {
    const fg_factor *factor = fg_experiment_main_factor(e, j);
    if (!factor || factor->variable != idle->variable || !isfinite(e->effect[j].low)) continue;
    fg_value_with_unit(column, fg_factor_real(factor, -1), 6, n[0], sizeof n[0]);
    fg_value_with_unit(column, fg_factor_real(factor, 1), 6, n[1], sizeof n[1]);
    fg_value_with_unit(e->response, 2 * e->regression.coefficient[j].estimate, 2, n[2],
                       sizeof n[2]);
    fg_value_with_unit(e->response, 2 * e->effect[j].low, 2, n[3], sizeof n[3]);
    fg_value_with_unit(e->response, 2 * e->effect[j].high, 2, n[4], sizeof n[4]);
    fg_experiment_reference_words(e, idle->variable, reference, sizeof reference);
    fg_text_clip(change, sizeof change,
                 "; from %s to %s it changes the response by %s%s, %g %% interval %s to %s", n[0],
                 n[1], n[2], reference, 100 * e->confidence, n[3], n[4]);
  }
  return fg_sentences_add(ctx, s,
                          "%s cannot be told from the scatter%s: as far as these runs tell any "
                          "setting will do, the cheapest first%s.",
                          name, p_value, change);
}

static fg_status conclude_idles(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  if (!e->reduced && !e->idle.all) return FG_OK;
  for (size_t i = 0; i < e->idle.count; i++)
    FG_TRY(conclude_idle(ctx, e, &e->idle.factor[i], s));
  if (!e->reduced) return FG_OK;
  return fg_sentences_add(ctx, s, "The best setting is that of the model without %s: %s.",
                          e->idle.count > 1 ? "them" : "it", e->reduced->formula);
}

fg_status fg_experiment_conclude_lack(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  char p_value[16];
  fg_p_value_text(p_value, e->regression.lack_p_value);
  return fg_sentences_add(ctx, s,
                          "Not sure: the model does not fit; beside the scatter of repeated runs "
                          "the lack of fit is significant (p %s%s). Add terms or transform.",
                          *p_value == '<' ? "" : "= ", p_value);
}

/* Tells an optimum at the border of the runs from one that a constraint holds. */
static fg_status conclude_border(fg_context *ctx, const fg_experiment *best, fg_sentences *s) {
  if (best->best.optimum.on_edge_of_runs)
    return fg_sentences_add(ctx, s,
                            "It lies on the border of the region: the best may lie beyond, where "
                            "there are no runs.");
  return fg_sentences_add(ctx, s,
                          "It lies on a constraint: the best may lie beyond what was allowed.");
}

/* Reasons for and against trust in the best setting, the gravest first. */
static fg_status conclude_trust(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  const fg_experiment *best = fg_experiment_best(e);
  const fg_prediction *p = &fg_experiment_best_point(e)->prediction;
  size_t before = s->count;
  if (!e->idle.all && e->regression.model_p_value > 1 - e->confidence)
    FG_TRY(fg_sentences_add(ctx, s,
                            "Not sure: the model as a whole cannot be told from the mean (p = "
                            "%.3f). It is a setting to test, not a finding.",
                            e->regression.model_p_value));
  if (fg_experiment_lacks_fit(e)) FG_TRY(fg_experiment_conclude_lack(ctx, e, s));
  if (best->best.optimum.on_border && !e->idle.all) FG_TRY(conclude_border(ctx, best, s));
  if (!isfinite(p->low))
    FG_TRY(fg_sentences_add(ctx, s,
                            "Not sure: how sure cannot be said, as no degree of freedom is left "
                            "for an error. Repeat runs."));
  if (s->count == before && !e->idle.all)
    FG_TRY(fg_sentences_add(
        ctx, s, "It lies inside the region of the runs, by a model that they do not contradict."));
  if (!e->idle.all && isfinite(p->low))
    FG_TRY(fg_sentences_add(
        ctx, s,
        "The intervals hold at all settings of the region at once, so also at this one, which the "
        "same runs chose. For a setting that was chosen without these runs --at has narrower "
        "ones."));
  if (e->magnitude && !e->idle.all && isfinite(p->run_low) && p->run_low < 0)
    FG_TRY(fg_sentences_add(
        ctx, s, "A magnitude cannot be below 0: where an interval reaches further, read 0."));
  return FG_OK;
}

fg_status fg_experiment_conclude_best(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  const fg_experiment *best = fg_experiment_best(e);
  char setting[700];
  s->trust = s->setting = s->count;
  if (!best->best.found) return FG_OK;
  if (e->idle.all) {
    FG_TRY(conclude_no_best(ctx, e, s));
  } else {
    FG_TRY(conclude_rounded(ctx, e, s));
    put_setting(e, best->best.optimum.x, true, setting, sizeof setting);
    FG_TRY(conclude_expected(ctx, e,
                             e->constraints
                                 ? "Best setting in the region of the data and the constraints"
                                 : "Best setting in the region of the data",
                             setting, &best->best.optimum.prediction, s));
  }
  s->trust = s->count;
  FG_TRY(conclude_trust(ctx, e, s));
  s->trusts = s->count - s->trust;
  return conclude_idles(ctx, e, s);
}

/* Standard deviation of the blocks' estimates, of which the first is 0; NaN: one is aliased. */
static double scatter_of_blocks(const fg_experiment *e, size_t *blocks) {
  double sum = 0, squares = 0;
  *blocks = 1;
  for (size_t j = 0; j < e->regression.columns; j++) {
    const fg_coefficient *c = &e->regression.coefficient[j];
    if (!e->effect[j].block) continue;
    if (c->aliased) return NAN;
    ++*blocks;
    sum += c->estimate;
    squares += c->estimate * c->estimate;
  }
  double count = (double)*blocks;
  return *blocks > 1 ? sqrt(fmax(squares - sum * sum / count, 0) / (count - 1)) : NAN;
}

fg_status fg_experiment_conclude_blocks(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  size_t blocks;
  char scatter[80];
  if (!e->block || (!e->best.found && !e->askeds)) return FG_OK;
  double sd = scatter_of_blocks(e, &blocks);
  if (!isfinite(sd)) return FG_OK;
  fg_value_with_unit(e->response, sd, 3, scatter, sizeof scatter);
  return fg_sentences_add(ctx, s,
                          "Expected responses and their intervals are of the mean of these %zu "
                          "blocks (%s), which scatter with a standard deviation of %s. A run in "
                          "another block scatters by that as well: it may fall outside.",
                          blocks, e->block, scatter);
}
