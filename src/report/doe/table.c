/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An experiment for the terminal. */
#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "report/doe/members.h"
#include "report/value_words.h"

static void put_doe_number(FILE *out, int width, double value) {
  if (isfinite(value))
    fprintf(out, "%*.*g", width, 4, value);
  else
    fprintf(out, "%*s", width, "-");
}

static void put_p(FILE *out, double p_value) {
  if (!isfinite(p_value))
    fprintf(out, "%10s", "-");
  else if (p_value < 0.0001)
    fprintf(out, "%10s", "< 0.0001");
  else
    fprintf(out, "%10.4f", p_value);
}

static void put_coefficients(FILE *out, const fg_doe_whole *whole) {
  fputc('\n', out);
  fg_members_terminal(out, "", &fg_doe_coefficient_members,
                      &(fg_subject){.object = whole, .whole = whole}, fg_doe_coefficient_at);
  fprintf(out, "intervals: %g %%%s\n", 100 * whole->e->confidence,
          whole->e->regression.aliases
              ? "; terms without numbers cannot be told from the ones above"
              : "");
}

static void put_anova_row(FILE *out, const fg_anova_row *row) {
  fprintf(out, "%-30s%6zu", row->name, row->dof);
  put_doe_number(out, 12, row->sum_of_squares);
  put_doe_number(out, 12, row->mean_square);
  put_doe_number(out, 10, row->f);
  put_p(out, row->p_value);
  fputc('\n', out);
}

static void put_error_row(FILE *out, const char *name, size_t dof, double sum, double f,
                          double p_value) {
  const fg_anova_row row = {(char *)(uintptr_t)name,       dof, sum,
                            dof ? sum / (double)dof : NAN, f,   p_value};
  put_anova_row(out, &row);
}

/* Writes the terms by restricted likelihood: each has an error of its own. */
static void put_mixed(FILE *out, const fg_split_plot *s) {
  fprintf(out, "\n%-30s%6s%12s%10s%10s\n", "tests of the terms", "df", "error df", "F", "p");
  for (size_t t = 0; t < s->terms; t++) {
    const fg_anova_row *row = &s->term[t].row;
    fprintf(out, "%-30s%6zu", row->name, row->dof);
    put_doe_number(out, 12, s->term[t].error_dof);
    put_doe_number(out, 10, row->f);
    put_p(out, row->p_value);
    fputc('\n', out);
  }
  fprintf(out, "standard deviation of whole plots");
  put_doe_number(out, 12, sqrt(s->plot_variance));
  fprintf(out, ", of runs within them");
  put_doe_number(out, 12, sqrt(s->run_variance));
  fputc('\n', out);
}

static void put_anova(FILE *out, const fg_experiment *e) {
  const fg_regression *r = &e->regression;
  if (e->has_split_plot && e->split_plot.mixed) {
    put_mixed(out, &e->split_plot);
    return;
  }
  fprintf(out, "\n%-30s%6s%12s%12s%10s%10s\n", "analysis of variance", "df", "sum sq", "mean sq",
          "F", "p");
  if (e->has_split_plot) {
    const fg_split_plot *s = &e->split_plot;
    for (int whole = 1; whole >= 0; whole--) {
      for (size_t t = 0; t < s->terms; t++)
        if (s->term[t].whole_plot == (size_t)whole) put_anova_row(out, &s->term[t].row);
      put_error_row(out, whole ? "(error of whole plots)" : "(error of runs)",
                    whole ? s->plot_dof : s->run_dof, whole ? s->plot_ss : s->run_ss, NAN, NAN);
    }
    return;
  }
  for (size_t t = 0; t < r->terms; t++)
    put_anova_row(out, &r->sequential[t]);
  put_error_row(out, "(residual)", r->residual_dof, r->residual_ss, NAN, NAN);
  if (!r->pure_dof) return;
  if (r->lack_dof)
    put_error_row(out, "  (lack of fit)", r->lack_dof, r->lack_ss, r->lack_f, r->lack_p_value);
  put_error_row(out, "  (pure error)", r->pure_dof, r->pure_ss, NAN, NAN);
}

static void put_quality(FILE *out, const fg_experiment *e) {
  const fg_regression *r = &e->regression;
  fprintf(out, "\nR² %.4f, adjusted ", r->r2);
  put_doe_number(out, 0, r->adjusted_r2);
  fputs(", predicted ", out);
  put_doe_number(out, 0, r->predicted_r2);
  fputs("; adequate precision ", out);
  put_doe_number(out, 0, r->adequate_precision);
  fprintf(out, "; condition number %.4g\n", r->condition_number);
}

static void put_doe_head(FILE *out, const fg_experiment_report *report, const char *response) {
  const fg_experiment *e = report->experiment;
  fprintf(out, "%s: %zu runs\nresponse: %s\nmodel: %s\n", report->path, e->regression.rows,
          response, e->formula);
  for (size_t k = 0; k < e->factors; k++)
    if (e->factor[k].coded)
      fprintf(out, "  %s: -1 is %g, +1 is %g\n", e->factor[k].name,
              fg_factor_real(&e->factor[k], -1), fg_factor_real(&e->factor[k], 1));
}

fg_status fg_experiment_write_table(fg_context *ctx, const fg_experiment_report *report,
                                    FILE *out) {
  const fg_experiment *e = report->experiment;
  fg_sentences conclusions = {0};
  char *response = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_experiment_response_words(ctx, e, &response));
  FG_TRY_EXIT(fg_experiment_conclusions(ctx, report, &conclusions));
  put_doe_head(out, report, response);
  fg_doe_whole whole;
  fg_doe_whole_of(report, &conclusions, &whole);
  put_coefficients(out, &whole);
  put_anova(out, e);
  put_quality(out, e);
  fputc('\n', out);
  for (size_t i = 0; i < conclusions.count; i++)
    if (fg_sentence_is_command(conclusions.text[i]))
      fprintf(out, "    %s\n", conclusions.text[i]);
    else
      fg_write_wrapped(out, "* ", "  ", conclusions.text[i]);
  for (size_t i = 0; i < e->notes; i++)
    fg_write_wrapped(out, "! ", "  ", e->note[i]);
  if (report->plan_note) fg_write_wrapped(out, "! ", "  ", report->plan_note);
  FG_TRY_EXIT(fg_stream_finish(ctx, out, "the table"));
exit:
  fg_sentences_free(&conclusions);
  free(response);
  return status;
}
