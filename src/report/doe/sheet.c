/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plan's run sheet as a page: to be printed and filled in at the oven. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/plan.h"
#include "page/page.h"
#include "report/unit_words.h"

enum { WORDS = 320 };

static void put_factors(FILE *out, const fg_plan *plan) {
  fputs("<dl class=\"facts\">", out);
  for (size_t k = 0; k < plan->factors; k++) {
    char words[WORDS], low[WORDS], high[WORDS], step[WORDS];
    fg_name_words(plan->name[k], words, sizeof words);
    fg_value_with_unit(plan->name[k], plan->low[k], 6, low, sizeof low);
    fg_value_with_unit(plan->name[k], plan->high[k], 6, high, sizeof high);
    fputs("<dt>", out);
    fg_html_text(out, words);
    fprintf(out, "</dt><dd>low (−1) %s, high (+1) %s", low, high);
    if (plan->step[k] > 0) {
      fg_value_with_unit(plan->name[k], plan->step[k], 6, step, sizeof step);
      fprintf(out, "; settings are multiples of %s", step);
    }
    fputs("</dd>", out);
  }
  fputs("</dl>\n", out);
}

static void put_heads(FILE *out, const fg_plan *plan, const char *const *column, size_t columns) {
  char words[WORDS];
  fputs("<thead><tr><th>run</th>", out);
  if (plan->blocks > 1) fputs("<th>block</th>", out);
  if (plan->plots) fputs("<th>whole<br>plot</th>", out);
  for (size_t k = 0; k < plan->factors; k++) {
    fg_axis_words(plan->name[k], words, sizeof words);
    fputs("<th>", out);
    fg_html_text(out, words);
    fputs("</th>", out);
  }
  fputs("<th class=\"w\">point</th>", out);
  for (size_t k = 0; k < columns; k++) {
    fputs("<th class=\"w\">", out);
    fg_html_text(out, column[k]);
    fputs("</th>", out);
  }
  fputs("<th class=\"w\">date, by whom, what was odd</th></tr></thead>\n", out);
}

/* A line above the first run of a block or of an oven load. */
static bool begins(const fg_plan *plan, size_t i) {
  return i && (plan->run[i].block != plan->run[i - 1].block ||
               plan->run[i].plot != plan->run[i - 1].plot);
}

static void put_run(FILE *out, const fg_plan *plan, size_t i, size_t columns) {
  const fg_plan_run *run = &plan->run[i];
  fprintf(out, "<tr%s><td>%zu</td>", begins(plan, i) ? " class=\"begins\"" : "", i + 1);
  if (plan->blocks > 1) fprintf(out, "<td>%zu</td>", run->block);
  if (plan->plots) fprintf(out, "<td>%zu</td>", run->plot);
  for (size_t k = 0; k < plan->factors; k++)
    fprintf(out, "<td><b>%.6g</b></td>", fg_plan_setting(plan, i, k));
  fprintf(out, "<td class=\"words\">%s</td>", run->point);
  for (size_t k = 0; k <= columns; k++)
    fputs("<td class=\"blank\"></td>", out);
  fputs("</tr>\n", out);
}

/* Rounded settings, and ones that may be impossible. */
static fg_status put_notes(fg_context *ctx, FILE *out, const fg_plan *plan) {
  char *notes, *rest = NULL;
  FG_TRY(fg_plan_notes(ctx, plan, &notes));
  if (*notes) {
    fputs("<ul class=\"flags\">\n", out);
    for (char *line = strtok_r(notes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
      fputs("<li>", out);
      fg_html_text(out, line);
      fputs("</li>\n", out);
    }
    fputs("</ul>\n", out);
  }
  free(notes);
  return FG_OK;
}

fg_status fg_plan_write_html(fg_context *ctx, const fg_plan *plan, const char *const *column,
                             size_t columns, FILE *out) {
  fg_html_begin(out, "Run sheet");
  fprintf(out,
          "<section class=\"part\">\n<header><h1>Run sheet: %zu run%s</h1><p>to be made in "
          "this order",
          plan->runs, fg_plural(plan->runs));
  if (plan->plots)
    fprintf(out, "; %zu whole plots, each one setting of what is hard to change", plan->plots);
  fputs("</p></header>\n", out);
  FG_TRY(put_notes(ctx, out, plan));
  put_factors(out, plan);
  fputs("<h2>Runs</h2>\n<div class=\"scroll\"><table class=\"sheet\">", out);
  put_heads(out, plan, column, columns);
  fputs("<tbody>\n", out);
  for (size_t i = 0; i < plan->runs; i++)
    put_run(out, plan, i, columns);
  fputs("</tbody></table></div>\n<p class=\"note\">The order is random so that nothing that drifts "
        "looks like an effect: a run that has to move gets a note. What was set instead goes into "
        "the table as it was set.</p>\n</section>\n",
        out);
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the run sheet");
}
