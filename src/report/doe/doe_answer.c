/* What an experiment's page says first: the best setting, what it gives, and how sure that is. */
#include <math.h>
#include <string.h>

#include "report/doe/doe_answer.h"
#include "report/doe/doe_units.h"
#include "report/measure/measure_page_parts.h"

/* Why there is no best setting, where there is none. */
static const char *why_no_optimum(const fg_experiment *e) {
  for (size_t i = 0; i < e->notes; i++)
    if (!strncmp(e->note[i], "no optimum", 10)) return e->note[i];
  return "no optimum";
}

/* The factor that does most, where no surface says more: a screening's answer. */
static void put_strongest(FILE *out, const fg_experiment *e, const fg_sentences *conclusions) {
  fputs("<p class=\"set\">No best setting</p>\n<p>", out);
  fg_html_text(out, why_no_optimum(e));
  fputs(".</p>\n", out);
  for (size_t i = 0; i < conclusions->count; i++)
    if (strstr(conclusions->text[i], " matters: ")) {
      fputs("<p><b>What matters:</b> ", out);
      fg_html_text(out, conclusions->text[i]);
      fputs("</p>\n", out);
      return;
    }
}

static void put_interval(FILE *out, const char *name, double low, double high) {
  char a[80], b[80];
  fg_value_with_unit("", low, 3, a, sizeof a);
  fg_value_with_unit(name, high, 3, b, sizeof b);
  fprintf(out, "%s to %s", a, b);
}

/* How far the best setting is to be trusted, in order of what stands most against it. */
static void put_doubts(FILE *out, const fg_experiment *e, const fg_optimum *best) {
  const fg_regression *r = &e->regression;
  bool any = false;
  fputs("<ul>\n", out);
  if (r->model_p_value > 1 - e->confidence) {
    fprintf(out,
            "<li class=\"doubt\">Not sure: the model as a whole cannot be told from the mean "
            "(p = %.3f). It is a setting to test, not a finding.</li>\n",
            r->model_p_value);
    any = true;
  }
  if (r->pure_freedom && r->lack_freedom && r->lack_p_value < 1 - e->confidence) {
    fprintf(out,
            "<li class=\"doubt\">Not sure: the model does not fit the repeated runs (lack of fit, "
            "p = %.4f).</li>\n",
            r->lack_p_value);
    any = true;
  }
  if (best->on_border) {
    fputs("<li>It lies on the border of the region: the best may lie beyond, where there are no "
          "runs.</li>\n",
          out);
    any = true;
  }
  if (!isfinite(best->prediction.low)) {
    fputs("<li class=\"doubt\">How sure cannot be said: there is no freedom for an error. Repeat "
          "runs.</li>\n",
          out);
    any = true;
  }
  if (!any)
    fputs("<li>Inside the region of the runs, by a model that the runs do not contradict.</li>\n",
          out);
  fputs("</ul>\n", out);
}

static void put_best(FILE *out, const fg_experiment *e) {
  const fg_optimum *best = e->has_rounded ? &e->rounded : &e->optimum;
  const fg_prediction *p = &best->prediction;
  char setting[700], value[80];
  fg_experiment_setting_words(e, best->x, setting, sizeof setting);
  fputs("<p class=\"set\">", out);
  fg_html_text(out, setting);
  fputs("</p>\n<p>", out);
  if (e->has_rounded) {
    fg_experiment_setting_words(e, e->optimum.x, setting, sizeof setting);
    fputs("The best of the settings that can be made; without rounding: ", out);
    fg_html_text(out, setting);
    fputs(". ", out);
  }
  fg_value_with_unit(e->response, p->mean, 4, value, sizeof value);
  fprintf(out, "It gives <b>%s</b>", value);
  if (isfinite(p->low)) {
    fprintf(out, ", with %g %% confidence ", 100 * e->confidence);
    put_interval(out, e->response, p->low, p->high);
    fputs("; one run to confirm it should come out at ", out);
    put_interval(out, e->response, p->run_low, p->run_high);
  }
  fputs(".", out);
  if (e->magnitude && isfinite(p->run_low) && p->run_low < 0)
    fputs(" A magnitude cannot be below 0: where an interval reaches further, read 0.", out);
  fputs("</p>\n", out);
  put_doubts(out, e, best);
}

void fg_doe_put_answer(FILE *out, const fg_experiment *e, const fg_sentences *conclusions) {
  char words[300];
  fg_name_words(e->response, words, sizeof words);
  fputs("<div class=\"answer\">\n<h2 class=\"first\">", out);
  if (e->has_optimum && e->goal == FG_GOAL_TARGET)
    fprintf(out, "Best setting for %.6g of ", e->target);
  else
    fprintf(out, "Best setting for the %s ", e->goal == FG_GOAL_HIGHEST ? "highest" : "lowest");
  fg_html_text(out, words);
  fputs("</h2>\n", out);
  if (e->has_optimum)
    put_best(out, e);
  else
    put_strongest(out, e, conclusions);
  fputs("</div>\n", out);
}

/* The rest of what is said: the answer has stood above. */
void fg_doe_put_conclusions(FILE *out, const fg_sentences *conclusions) {
  static const char *const told[] = {"Best setting ", "A magnitude cannot", "It lies on the border",
                                     "Beware: the model as a whole"};
  fputs("<h2>What the runs say</h2>\n<ul class=\"words\">\n", out);
  for (size_t i = 0; i < conclusions->count; i++) {
    const char *text = conclusions->text[i];
    bool above = false;
    for (size_t k = 0; k < sizeof told / sizeof *told; k++)
      above = above || !strncmp(text, told[k], strlen(told[k]));
    if (above) continue;
    bool command = fg_sentence_is_command(text);
    fputs(command ? "<li class=\"command\"><code>" : "<li>", out);
    fg_html_text(out, text);
    fputs(command ? "</code></li>\n" : "</li>\n", out);
  }
  fputs("</ul>\n", out);
}
