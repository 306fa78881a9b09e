/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conclusions on settings that were asked for: their response, and the best along each factor. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/doe/words.h"
#include "report/unit_words.h"

static void put_setting(const fg_experiment *e, const fg_asked *asked, char *text, size_t size) {
  *text = '\0';
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    const fg_levels *levels = &e->model.levels[v];
    const char *column = e->model.formula.variable[v].column;
    char name[300], value[200] = "";
    size_t used = strlen(text);
    if (v == e->block_variable) continue;
    fg_name_words(column, name, sizeof name);
    if (levels->count)
      fg_text_clip(value, sizeof value, "%s", levels->name[(size_t)asked->setting[v]]);
    for (size_t f = 0; f < e->factors; f++)
      if (e->factor[f].variable == v)
        fg_value_with_unit(column, fg_factor_real(&e->factor[f], asked->setting[v]), 6, value,
                           sizeof value);
    fg_text_clip(text + used, size - used, "%s%s %s", used ? ", " : "", name, value);
  }
}

/* Writes "3.72 % at temperature 694 °C" where that beats the setting by a difference that the
 * digits show. */
static void put_better(const fg_experiment *e, const fg_asked *asked, char *text, size_t size) {
  *text = '\0';
  for (size_t f = 0; f < e->factors; f++) {
    const fg_factor *factor = &e->factor[f];
    size_t v = factor->variable, used = strlen(text);
    char name[300], place[80], best[80], here[80];
    fg_value_with_unit(e->response, asked->best_mean[v], 3, best, sizeof best);
    fg_value_with_unit(e->response, asked->prediction.mean, 3, here, sizeof here);
    if (!strcmp(best, here)) continue;
    fg_name_words(factor->name, name, sizeof name);
    fg_value_with_unit(factor->name, fg_factor_real(factor, asked->best_at[v]), 4, place,
                       sizeof place);
    fg_text_clip(text + used, size - used, "%s%s at %s %s", used ? ", " : "", best, name, place);
  }
}

static fg_status conclude_one_asked(fg_context *ctx, const fg_experiment *e, const fg_asked *asked,
                                    fg_sentences *s) {
  const fg_prediction *p = &asked->prediction;
  const double numbers[5] = {p->mean, p->low, p->high, p->run_low, p->run_high};
  char setting[700], n[5][80], interval[400] = "", better[900];
  for (int i = 0; i < 5; i++)
    fg_value_with_unit(e->response, numbers[i], i ? 3 : 4, n[i], sizeof n[i]);
  if (isfinite(p->low))
    fg_text_clip(
        interval, sizeof interval,
        " (%g %% interval %s to %s, if it was chosen without these runs; one run %s to %s)",
        100 * e->confidence, n[1], n[2], n[3], n[4]);
  put_setting(e, asked, setting, sizeof setting);
  put_better(e, asked, better, sizeof better);
  return fg_sentences_add(
      ctx, s, "Asked for: at %s the model as given expects %s%s. %s%s%s%s", setting, n[0], interval,
      *better ? "That is not the best along each factor by itself: "
              : "It is the best along every factor",
      better, *better ? ", the others as asked." : ".",
      asked->inside ? "" : " It lies beyond the runs: what is said of it is extrapolated.");
}

fg_status fg_experiment_conclude_asked(fg_context *ctx, const fg_experiment *e, fg_sentences *s) {
  for (size_t i = 0; i < e->askeds; i++)
    FG_TRY(conclude_one_asked(ctx, e, &e->asked[i], s));
  return FG_OK;
}
