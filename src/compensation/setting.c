/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A setting s changes the springback of the lots' setting s0 by c = w(s) / w(s0), w = ln(1 + e /
 * 100) of the experiment's springback error e. Its u takes both predictions as independent, which
 * is too wide near s0; there c = 1 exactly. Bumps need not follow the experiment's response: half
 * of the change is added to u, so that no change at all lies at two standard deviations. */
#include "compensation/setting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compensation/springback.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/doe.h"
#include "foilgauge/experiment.h"

enum { FIRST_LEVELS = 9, SECOND_LEVELS = 3, TEXT = sizeof((fg_setting_trade *)0)->text };

/* Part of a change that bumps may not follow. */
static const double unfollowed_share = 0.5;

typedef struct setting_search {
  const fg_setting_request *request;
  fg_next_die *next;
  fg_experiment experiment;
} setting_search;

static fg_status analyse_runs(fg_context *ctx, const fg_table *runs, const char *const *at,
                              size_t ats, setting_search *search) {
  const fg_experiment_options options = {.response = search->request->response,
                                         .formula = search->request->formula,
                                         .sign = FG_SIGN_MAGNITUDE,
                                         .goal = FG_GOAL_LOWEST,
                                         .at = at,
                                         .ats = ats};
  return fg_experiment_analyse(ctx, runs, &options, &search->experiment);
}

/* Value of a factor in "temperature_C=650, duration_h=5"; NaN: not named. */
static double setting_value(const char *text, const char *name) {
  size_t length = strlen(name);
  for (const char *at = text; at && *at; at = strchr(at, ','), at += at != NULL) {
    at += strspn(at, " ");
    if (!strncmp(at, name, length) && strspn(at + length, " =") && strchr(at, '='))
      return strtod(strchr(at, '=') + 1, NULL);
  }
  return NAN;
}

/* Writes the lots' setting with other values of the first two factors. */
static void write_setting(const setting_search *search, double first, double second,
                          fg_setting_trade *trade) {
  const fg_experiment *e = &search->experiment;
  size_t used = 0;
  trade->first = first;
  trade->second = e->factors > 1 ? second : NAN;
  for (size_t i = 0; i < e->factors && used < TEXT; i++) {
    double value = i == 0   ? first
                   : i == 1 ? second
                            : setting_value(search->request->setting, e->factor[i].name);
    used += (size_t)snprintf(trade->text + used, TEXT - used, "%s%s=%.6g", i ? ", " : "",
                             e->factor[i].name, value);
  }
}

static double factor_level(const fg_factor *factor, size_t level, size_t levels) {
  double share = levels > 1 ? (double)level / (double)(levels - 1) : 0;
  double low = fg_factor_real(factor, factor->lowest),
         high = fg_factor_real(factor, factor->highest);
  return low + share * (high - low);
}

/* The lots' setting first, then a grid over the runs' range of the first two factors. */
static void list_settings(setting_search *search) {
  const fg_experiment *e = &search->experiment;
  fg_next_die *next = search->next;
  double own[2] = {NAN, NAN};
  for (size_t i = 0; i < e->factors && i < 2; i++)
    own[i] = setting_value(search->request->setting, e->factor[i].name);
  write_setting(search, own[0], own[1], &next->setting[next->settings++]);
  for (size_t b = 0; b < (e->factors > 1 ? SECOND_LEVELS : 1); b++)
    for (size_t a = 0; a < FIRST_LEVELS; a++)
      write_setting(search, factor_level(&e->factor[0], a, FIRST_LEVELS),
                    e->factors > 1 ? factor_level(&e->factor[1], b, SECOND_LEVELS) : NAN,
                    &next->setting[next->settings++]);
}

/* Mean over the places of the law at the target's size, and of its u with the next set. */
static void mean_law(const fg_springback_fit *fit, double *mean, double *u) {
  *mean = *u = 0;
  for (size_t i = 0; i < fit->places; i++) {
    *mean += fg_springback_mean(fit, i, fit->reference) / (double)fit->places;
    *u += fg_springback_u(fit, i, fit->reference, true) / (double)fit->places;
  }
}

static double die_size(const fg_springback_fit *fit, double springback, double share) {
  return exp(fit->reference -
             share * springback / (1 + share * fit->state_mean[FG_STATE_EXPONENT]));
}

static double log_of_error(double pct) {
  return log1p(pct / 100);
}

static void fill_trade(const fg_next_die *next, const fg_prediction *own,
                       const fg_prediction *prediction, bool same, fg_setting_trade *trade) {
  const fg_springback_fit *overall = &next->laws->of[FG_FORMED_OVERALL];
  const fg_springback_fit *fit = next->die.bumps ? &next->laws->of[FG_FORMED_RADIUS] : overall;
  double w0 = log_of_error(own->mean), w = log_of_error(prediction->mean), mean, u, whole, u_whole;
  double share = same ? 1 : w / w0;
  double u0 = own->standard_error / 100, u1 = prediction->standard_error / 100;
  trade->share = share;
  trade->u_share =
      same ? 0
           : sqrt(u1 * u1 + share * share * u0 * u0 + pow(unfollowed_share * (share - 1) * w0, 2)) /
                 fabs(w0);
  mean_law(fit, &mean, &u);
  mean_law(overall, &whole, &u_whole);
  trade->springback_pct = 100 * share * mean;
  trade->u_next_pct = 100 * hypot(share * u, mean * trade->u_share);
  trade->radius_mm = next->die.bumps ? die_size(fit, mean, share) : NAN;
  trade->overall_radius_mm = die_size(overall, whole, share);
}

/* Settings that the experiment predicts to close the foil tell nothing of it. */
static fg_status fill_trades(fg_context *ctx, setting_search *search) {
  fg_next_die *next = search->next;
  const fg_experiment *e = &search->experiment;
  const fg_prediction *own = &e->asked[0].prediction;
  if (!(own->mean > own->standard_error))
    return fg_fail(ctx, FG_ERR_DATA,
                   "the experiment does not tell the springback of the lots' setting (%s: %.3g %%, "
                   "standard error %.3g %%) from none",
                   next->setting[0].text, own->mean, own->standard_error);
  for (size_t i = 0; i < next->settings; i++) {
    fg_setting_trade *trade = &next->setting[i];
    const fg_prediction *prediction = &e->asked[i].prediction;
    bool same = trade->first == next->setting[0].first &&
                (trade->second == next->setting[0].second || isnan(trade->second));
    bool opens = prediction->mean > 0;
    fill_trade(next, own, opens ? prediction : own, same || !opens, trade);
    if (!opens && !same)
      trade->share = trade->u_share = trade->u_next_pct = trade->springback_pct = trade->radius_mm =
          trade->overall_radius_mm = NAN;
    if (trade->u_next_pct < next->setting[next->chosen].u_next_pct) next->chosen = i;
  }
  return FG_OK;
}

static fg_status find_trades(fg_context *ctx, const fg_table *runs, setting_search *search) {
  const char *at[FG_COMPENSATION_SETTINGS];
  fg_next_die *next = search->next;
  FG_TRY(analyse_runs(ctx, runs, &search->request->setting, 1, search));
  if (!search->experiment.factors)
    return fg_fail(ctx, FG_ERR_USAGE, "--doe-model has no numeric factor");
  list_settings(search);
  fg_experiment_free(&search->experiment);
  for (size_t i = 0; i < next->settings; i++)
    at[i] = next->setting[i].text;
  FG_TRY(analyse_runs(ctx, runs, at, next->settings, search));
  for (size_t i = 0; i < 2 && i < search->experiment.factors; i++)
    fg_text_clip(next->factor[i], sizeof next->factor[i], "%s", search->experiment.factor[i].name);
  return fill_trades(ctx, search);
}

fg_status fg_setting_trade_find(fg_context *ctx, const fg_setting_request *request,
                                fg_next_die *next) {
  setting_search search = {.request = request, .next = next};
  fg_table runs = {.rows = 0};
  FG_TRY(fg_table_load(ctx, request->runs, &runs, next->doe_sha256));
  fg_text_clip(next->doe_path, sizeof next->doe_path, "%s", request->runs);
  fg_status status = find_trades(ctx, &runs, &search);
  fg_experiment_free(&search.experiment);
  fg_table_free(&runs);
  return status;
}
