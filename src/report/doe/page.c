/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page of an experiment: the answer first, then plots, then tables. */
#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/doe/answer.h"
#include "report/doe/members.h"
#include "report/doe/plots.h"
#include "report/doe/words.h"
#include "report/provenance.h"
#include "report/unit_words.h"

enum { RUNS_SHOWN = 200 };

static void put_doe_cell(FILE *out, double value, int digits) {
  if (isfinite(value))
    fprintf(out, "<td>%s%.*g</td>", value < 0 ? "−" : "", digits, fabs(value));
  else
    fputs("<td>–</td>", out);
}

static void put_p_cell(FILE *out, double p_value) {
  char text[16];
  fg_p_value_text(text, p_value);
  fputs("<td>", out);
  fg_html_text(out, text);
  fputs("</td>", out);
}

static void put_name_cell(FILE *out, const char *name) {
  fputs("<td>", out);
  fg_html_text(out, name);
  fputs("</td>", out);
}

static void put_list(FILE *out, const char *style, char *const *text, size_t count) {
  if (!count) return;
  fprintf(out, "<ul class=\"%s\">\n", style);
  for (size_t i = 0; i < count; i++) {
    bool command = fg_sentence_is_command(text[i]);
    fputs(command ? "<li class=\"command\"><code>" : "<li>", out);
    fg_html_text(out, text[i]);
    fputs(command ? "</code></li>\n" : "</li>\n", out);
  }
  fputs("</ul>\n", out);
}

static void put_doe_tiles(FILE *out, const fg_experiment *e) {
  const fg_regression *r = &e->regression;
  char dof[64], scatter[64] = "", r2[96] = "";
  snprintf(dof, sizeof dof, "%zu for the error", r->residual_dof);
  if (r->residual_dof) {
    fg_value_with_unit(e->response, r->residual_sd, 3, scatter, sizeof scatter);
    snprintf(r2, sizeof r2, "adjusted %.1f %%, predicted %.1f %%", 100 * r->adjusted_r2,
             100 * r->predicted_r2);
  }
  const fg_tile tiles[] = {
      {"Runs", .value = (double)r->rows, .small = dof},
      {r->residual_dof ? "Scatter about the model" : NULL, .text = scatter,
       .small = "standard deviation"},
      {r->residual_dof ? "R²" : NULL, .value = 100 * r->r2, .decimals = 1, .unit = "%",
       .small = r2},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_coefficients(FILE *out, const fg_doe_whole *whole) {
  fprintf(out, "<h2>Coefficients</h2>\n");
  fg_html_table(out, &fg_doe_coefficient_members, &(fg_subject){.object = whole, .whole = whole},
                fg_doe_coefficient_at);
  fprintf(out,
          "<p class=\"note\">A coefficient is the change of the response over half the range of a "
          "factor; relative: over the constant. Intervals: %g %%.</p>\n",
          100 * whole->e->confidence);
}

static void put_anova_row(FILE *out, const fg_anova_row *row, double partial, double partial_p) {
  put_name_cell(out, row->name);
  fprintf(out, "<td>%zu</td>", row->dof);
  put_doe_cell(out, row->sum_of_squares, 5);
  put_doe_cell(out, row->mean_square, 5);
  put_doe_cell(out, row->f, 4);
  put_p_cell(out, row->p_value);
  put_doe_cell(out, partial, 5);
  put_p_cell(out, partial_p);
  fputs("</tr>\n", out);
}

static void put_error_row(FILE *out, const char *name, size_t dof, double sum, double f,
                          double p_value) {
  const fg_anova_row row = {(char *)(uintptr_t)name,       dof, sum,
                            dof ? sum / (double)dof : NAN, f,   p_value};
  fputs("<tr>", out);
  put_anova_row(out, &row, NAN, NAN);
}

static void put_split_plot(FILE *out, const fg_split_plot *s) {
  for (size_t whole = 2; whole-- > 0;) {
    for (size_t t = 0; t < s->terms; t++) {
      if (s->term[t].whole_plot != whole) continue;
      fputs("<tr>", out);
      put_anova_row(out, &s->term[t].row, NAN, NAN);
    }
    put_error_row(out, whole ? "error of whole plots" : "error of runs",
                  whole ? s->plot_dof : s->run_dof, whole ? s->plot_ss : s->run_ss, NAN, NAN);
  }
}

/* Writes the terms by restricted likelihood: each has an error of its own. */
static void put_mixed(FILE *out, const fg_experiment *e) {
  const fg_split_plot *s = &e->split_plot;
  fputs("<h2>Tests of the terms</h2>\n<div class=\"scroll\"><table><thead><tr><th>term</th>"
        "<th>df</th><th>df of<br>its error</th><th>F</th><th>p</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t t = 0; t < s->terms; t++) {
    const fg_anova_row *row = &s->term[t].row;
    fputs(row->p_value < 1 - e->confidence ? "<tr class=\"on\">" : "<tr>", out);
    put_name_cell(out, row->name);
    fprintf(out, "<td>%zu</td>", row->dof);
    put_doe_cell(out, s->term[t].error_dof, 4);
    put_doe_cell(out, row->f, 4);
    put_p_cell(out, row->p_value);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n<p class=\"note\">Restricted likelihood, with the degrees of "
        "freedom of Kenward and Roger; each term beside all others, as the mean over "
        "the levels of words that the term interacts with.</p>\n",
        out);
}

static void put_anova(FILE *out, const fg_experiment *e) {
  const fg_regression *r = &e->regression;
  if (e->has_split_plot && e->split_plot.mixed) {
    put_mixed(out, e);
    return;
  }
  fputs("<h2>Analysis of variance</h2>\n<div class=\"scroll\"><table><thead><tr><th>term</th>"
        "<th>df</th><th>sum of<br>squares</th><th>mean<br>square</th><th>F</th><th>p</th>"
        "<th>partial<br>sum</th><th>partial<br>p</th></tr></thead>\n<tbody>\n",
        out);
  if (e->has_split_plot) put_split_plot(out, &e->split_plot);
  for (size_t t = 0; t < r->terms && !e->has_split_plot; t++) {
    fputs(r->sequential[t].p_value < 1 - e->confidence ? "<tr class=\"on\">" : "<tr>", out);
    put_anova_row(out, &r->sequential[t], r->partial[t].sum_of_squares, r->partial[t].p_value);
  }
  if (!e->has_split_plot) put_error_row(out, "residual", r->residual_dof, r->residual_ss, NAN, NAN);
  if (r->pure_dof && r->lack_dof && !e->has_split_plot) {
    put_error_row(out, "– lack of fit", r->lack_dof, r->lack_ss, r->lack_f, r->lack_p_value);
    put_error_row(out, "– pure error", r->pure_dof, r->pure_ss, NAN, NAN);
  }
  fputs("</tbody></table></div>\n<p class=\"note\">Sums of squares: each term after the ones above "
        "it; partial: after all others, as the mean over the levels of words that the term "
        "interacts with.</p>\n",
        out);
}

static void put_doe_runs(FILE *out, const fg_experiment_report *report) {
  const fg_experiment *e = report->experiment;
  const fg_regression *r = &e->regression;
  fputs("<h2>Runs</h2>\n<div class=\"scroll\"><table><thead><tr><th>row</th>", out);
  for (size_t k = 0; k < e->factors; k++) {
    char words[300];
    fg_axis_words(e->factor[k].name, words, sizeof words);
    fputs("<th>", out);
    fg_html_text(out, words);
    fputs("</th>", out);
  }
  fputs("<th>response</th><th>u</th><th>fitted</th><th>residual</th><th>studentised</th>"
        "<th>leverage</th><th>Cook</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < r->rows && i < RUNS_SHOWN; i++) {
    fprintf(out, "<tr><td>%zu</td>", report->row ? report->row[i] : i + 1);
    for (size_t k = 0; k < e->factors; k++)
      put_doe_cell(
          out,
          fg_factor_real(&e->factor[k],
                         e->setting[i * e->model.formula.variables + e->factor[k].variable]),
          6);
    put_doe_cell(out, r->fitted[i] + r->residual[i], 5);
    put_doe_cell(out, e->measurement.u ? e->measurement.u[i] : NAN, 2);
    put_doe_cell(out, r->fitted[i], 5);
    put_doe_cell(out, r->residual_dof ? r->residual[i] : 0, 3);
    put_doe_cell(out, r->external[i], 3);
    put_doe_cell(out, r->leverage[i], 3);
    put_doe_cell(out, r->cook[i], 3);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n", out);
  if (r->rows > RUNS_SHOWN)
    fprintf(out, "<p class=\"note\">The first %d of %zu runs; the JSON report has all.</p>\n",
            RUNS_SHOWN, r->rows);
}

static fg_status put_facts(fg_context *ctx, FILE *out, const fg_experiment_report *report,
                           const char *response) {
  const fg_experiment *e = report->experiment;
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\"><dt>Runs</dt><dd>", out);
  fg_html_text(out, report->path);
  fprintf(out, "</dd><dt>SHA-256</dt><dd>%s</dd><dt>Response</dt><dd>", report->sha256);
  fg_html_text(out, response);
  fputs("</dd><dt>Model</dt><dd>", out);
  fg_html_text(out, e->formula);
  fputs("</dd><dt>Coding</dt><dd>", out);
  for (size_t k = 0; k < e->factors; k++) {
    fg_html_text(out, e->factor[k].name);
    if (e->factor[k].coded)
      fprintf(out, ": −1 is %g, +1 is %g. ", fg_factor_real(&e->factor[k], -1),
              fg_factor_real(&e->factor[k], 1));
    else
      fputs(": real units. ", out);
  }
  if (report->plan_path) {
    fputs("</dd><dt>Plan</dt><dd>", out);
    fg_html_text(out, report->plan_path);
  }
  fprintf(out, "</dd><dt>Condition number</dt><dd>%.4g</dd>", e->regression.condition_number);
  if (e->has_box_cox)
    fprintf(out, "<dt>Box-Cox power</dt><dd>%.2f (95 %%: %.2f to %.2f)</dd>", e->box_cox.lambda,
            e->box_cox.low, e->box_cox.high);
  if (isfinite(e->regression.adequate_precision))
    fprintf(out, "<dt>Adequate precision</dt><dd>%.4g</dd>", e->regression.adequate_precision);
  fg_provenance from = {.design = report->design, .of_scans = report->scans > 0};
  fg_provenance_include_file(&from, report->path);
  FG_TRY(fg_html_provenance(ctx, out, &from));
  fputs("</dl>\n", out);
  return FG_OK;
}

static void begin_panels(FILE *out, const char *title, const char *note) {
  fprintf(out, "<h2>%s</h2>\n", title);
  if (note) fprintf(out, "<p class=\"note\">%s</p>\n", note);
  fputs("<div class=\"panels\">\n", out);
}

static void end_panels(FILE *out) {
  fputs("</div>\n", out);
}

static fg_status put_plots(fg_context *ctx, FILE *out, const fg_experiment_report *report) {
  const fg_experiment *e = report->experiment;
  begin_panels(out, "Size of the effects", NULL);
  FG_TRY(fg_doe_plot_effects(ctx, out, e));
  end_panels(out);
  begin_panels(out, "Main effects", "Mean of the runs at every level.");
  fg_doe_plot_main_effects(out, e);
  end_panels(out);
  if (e->factors >= 2) {
    begin_panels(out, "Interactions",
                 "Parallel lines: the two factors act independently. Other factors in the middle.");
    FG_TRY(fg_doe_plot_interactions(ctx, out, e));
    end_panels(out);
  }
  if (e->factors) {
    begin_panels(
        out, "Response along each factor",
        "The model with its interval, the other factors in the middle; circles: the runs.");
    FG_TRY(fg_doe_plot_profiles(ctx, out, e));
    end_panels(out);
  }
  const fg_experiment *best = fg_experiment_best(e);
  if (best->best.found && best->surface.factors >= 2) {
    begin_panels(out, "Response surface",
                 "Through the best setting (red diamond). Circles: the runs. Pale, behind the "
                 "dark edge: outside the region of the data or the constraints.");
    fg_doe_plot_contours(out, best);
    end_panels(out);
  }
  if (!e->regression.residual_dof) return FG_OK;
  begin_panels(out, "Residuals", "No pattern should show; the normal plot should be straight.");
  FG_TRY(fg_doe_plot_residuals(ctx, out, report));
  end_panels(out);
  return FG_OK;
}

static fg_status put_page(fg_context *ctx, FILE *out, const fg_experiment_report *report,
                          const fg_sentences *conclusions, const char *response) {
  const fg_experiment *e = report->experiment;
  char words[300];
  fg_axis_words(e->response, words, sizeof words);
  fg_html_begin(out, e->response);
  fputs("<section class=\"part\">\n<header><h1>", out);
  fg_html_text(out, words);
  fputs("</h1><p>designed experiment: ", out);
  fg_html_text(out, e->formula);
  fputs("</p></header>\n", out);
  fg_doe_put_answer(out, e, conclusions);
  put_doe_tiles(out, e);
  fg_doe_put_conclusions(out, conclusions);
  put_list(out, "flags", e->note, e->notes);
  if (report->plan_note) {
    fputs("<ul class=\"flags\"><li>", out);
    fg_html_text(out, report->plan_note);
    fputs("</li></ul>\n", out);
  }
  FG_TRY(put_plots(ctx, out, report));
  put_anova(out, e);
  fg_doe_whole whole;
  fg_doe_whole_of(report, conclusions, &whole);
  put_coefficients(out, &whole);
  put_doe_runs(out, report);
  FG_TRY(put_facts(ctx, out, report, response));
  fputs("</section>\n", out);
  fg_html_end(out);
  return FG_OK;
}

fg_status fg_experiment_write_html(fg_context *ctx, const fg_experiment_report *report, FILE *out) {
  fg_sentences conclusions = {0};
  char *response = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_experiment_response_words(ctx, report->experiment, &response));
  FG_TRY_EXIT(fg_experiment_conclusions(ctx, report, &conclusions));
  FG_TRY_EXIT(put_page(ctx, out, report, &conclusions, response));
  FG_TRY_EXIT(fg_stream_finish(ctx, out, "the page"));
exit:
  fg_sentences_free(&conclusions);
  free(response);
  return status;
}
