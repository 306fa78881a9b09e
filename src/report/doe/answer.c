/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The answer on an experiment's page: the best setting, its response, and the confidence in it. */
#include <math.h>
#include <string.h>

#include "page/page.h"
#include "report/doe/answer.h"
#include "report/unit_words.h"

/* Why there is no best setting, where there is none. */
static const char *explain_no_optimum(const fg_experiment *e) {
  for (size_t i = 0; i < e->notes; i++)
    if (!strncmp(e->note[i], "no optimum", 10)) return e->note[i];
  return "no optimum";
}

/* Writes the strongest factor, the answer of a screening, which has no surface. */
static void put_strongest(FILE *out, const fg_experiment *e, const fg_sentences *conclusions) {
  fputs("<p class=\"set\">No best setting</p>\n<p>", out);
  fg_html_text(out, explain_no_optimum(e));
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

/* Lists the reasons for and against trust in the best setting; those against are marked. */
static void put_trust(FILE *out, const fg_sentences *conclusions) {
  fputs("<ul>\n", out);
  for (size_t i = 0; i < conclusions->trusts; i++) {
    const char *text = conclusions->text[conclusions->trust + i];
    fputs(!strncmp(text, "Not sure", 8) ? "<li class=\"uncertain\">" : "<li>", out);
    fg_html_text(out, text);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
}

/* Writes the answer where no factor can be told from noise. */
static void put_no_best(FILE *out, const fg_sentences *conclusions) {
  fputs("<p class=\"set\">No best setting</p>\n", out);
  for (size_t i = conclusions->setting; i < conclusions->trust; i++) {
    fputs("<p>", out);
    fg_html_text(out, conclusions->text[i]);
    fputs("</p>\n", out);
  }
}

static void put_best(FILE *out, const fg_experiment *e) {
  const fg_experiment *of = fg_experiment_best(e);
  const fg_optimum *best = fg_experiment_best_point(e);
  const fg_prediction *p = &best->prediction;
  char setting[700], value[80];
  fg_experiment_setting_words(e, best->x, setting, sizeof setting);
  fputs("<p class=\"set\">", out);
  fg_html_text(out, setting);
  fputs("</p>\n<p>", out);
  if (of->best.has_rounded) {
    fg_experiment_setting_words(e, of->best.optimum.x, setting, sizeof setting);
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
  fputs(".</p>\n", out);
}

void fg_doe_put_answer(FILE *out, const fg_experiment *e, const fg_sentences *conclusions) {
  char words[300];
  fg_name_words(e->response, words, sizeof words);
  fputs("<div class=\"answer\">\n<h2 class=\"first\">", out);
  bool has_best = fg_experiment_best(e)->best.found;
  if (has_best && e->best.goal == FG_GOAL_TARGET)
    fprintf(out, "Best setting for %.6g of ", e->best.target);
  else
    fprintf(out, "Best setting for the %s ",
            e->best.goal == FG_GOAL_HIGHEST ? "highest" : "lowest");
  fg_html_text(out, words);
  fputs("</h2>\n", out);
  if (!has_best)
    put_strongest(out, e, conclusions);
  else if (e->idle.all)
    put_no_best(out, conclusions);
  else
    put_best(out, e);
  if (has_best) put_trust(out, conclusions);
  fputs("</div>\n", out);
}

/* Writes the other conclusions, below the answer. */
void fg_doe_put_conclusions(FILE *out, const fg_sentences *conclusions) {
  fputs("<h2>What the runs say</h2>\n<ul class=\"words\">\n", out);
  for (size_t i = 0; i < conclusions->count; i++) {
    const char *text = conclusions->text[i];
    if (i >= conclusions->setting && i < conclusions->trust + conclusions->trusts) continue;
    bool command = fg_sentence_is_command(text);
    fputs(command ? "<li class=\"command\"><code>" : "<li>", out);
    fg_html_text(out, text);
    fputs(command ? "</code></li>\n" : "</li>\n", out);
  }
  fputs("</ul>\n", out);
}
