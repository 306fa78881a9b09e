/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page: for every foil its verdict, key numbers and picture first, then tables and plots. */
#include <math.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "foilgauge/traceability.h"
#include "report/correction_words.h"
#include "report/measure/colour_lines_report.h"
#include "report/measure/drawing.h"
#include "report/measure/foil_view.h"
#include "report/measure/gauge_report.h"
#include "report/measure/grid_members.h"
#include "report/measure/page_tables.h"
#include "report/measure/picture_report.h"
#include "report/measure/scan_model_words.h"
#include "report/measure/thickness_budget.h"
#include "report/measure/uncertainty_budget.h"
#include "report/provenance.h"

static void put_flag_list(FILE *out, const fg_flag_words *words, unsigned flags,
                          unsigned findings) {
  if (!flags && !findings) return;
  fputs("<ul class=\"flags\">\n", out);
  for (; words->name; words++)
    if (flags & words->flag) fprintf(out, "<li>%s</li>\n", words->plain);
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++)
    if (findings & found->finding) fprintf(out, "<li>%s %s</li>\n", found->meaning, found->cure);
  fputs("</ul>\n", out);
}

static void put_flags(FILE *out, const fg_design *design, const fg_foil *foil) {
  put_flag_list(out, fg_foil_flag_words(), fg_foil_flags_told(design, foil),
                foil->strip.picture.findings);
}

/* Writes the findings of all discs together; the table has those of each disc. */
static void put_disc_findings(FILE *out, const fg_measurement *measurement) {
  put_flag_list(out, fg_bump_flag_words(), 0, measurement->picture.findings);
}

static fg_status put_facts(fg_context *ctx, FILE *out, const fg_design *design,
                           const fg_measurement *measurement) {
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\">\n<dt>Scan file</dt><dd>", out);
  fg_html_name(out, measurement->scan);
  fprintf(out, "</dd>\n<dt>Pixels</dt><dd>%lld × %lld, %d bit</dd>\n",
          (long long)measurement->file.width_px, (long long)measurement->file.height_px,
          measurement->file.bit_depth);
  fprintf(out, "<dt>Resolution</dt><dd>%.8g × %.8g dpi", measurement->dpi[0], measurement->dpi[1]);
  if (isfinite(measurement->file.dpi_file[0]))
    fprintf(out, " (the file says %.8g × %.8g)", measurement->file.dpi_file[0],
            measurement->file.dpi_file[1]);
  fputs("</dd>\n<dt>SHA-256</dt><dd>", out);
  fg_html_name(out, measurement->sha256);
  fputs("</dd>\n", out);
  fg_provenance from = {.design = design, .of_scans = true, .model = measurement->model};
  fg_provenance_include_date(&from, measurement->date);
  FG_TRY(fg_html_provenance(ctx, out, &from));
  fputs("</dl>\n", out);
  return FG_OK;
}

/* Explains ±, and s where the tiles have it. */
static void put_uncertainty(FILE *out, const fg_measurement *measurement, const fg_foil *foil) {
  char scale[FG_SCALE_WORDS];
  fg_scale_words(measurement->model, &measurement->design.calibration, scale, sizeof scale);
  const fg_foil_view *view = fg_foil_view_of(measurement->design.kind);
  fprintf(
      out,
      "<h2>What ± means</h2>\n<p class=\"note\">± is the expanded uncertainty U = 2 u (coverage "
      "factor k = 2, about 95 %%). u comes from the residuals with their correlation along the "
      "edge and from what %s. ",
      view->u_from);
  fg_html_text(out, scale);
  fputs(" A value passes when value ± U lies inside its tolerance, fails when "
        "it lies outside, and cannot be told when a limit runs through it.",
        out);
  if (foil && view->spread_over)
    fprintf(out, " s is the standard deviation over the n %s.", view->spread_over);
  fputs("</p>\n", out);
  fg_html_uncertainty_budget(out, measurement, foil);
}

/* Explains the measured and derived values of a flat foil. */
static void put_beam_words(FILE *out, const fg_design *design) {
  fputs("<h2>How a beam is measured</h2>\n<p class=\"note\">L runs along the beam's axis, midway "
        "between its long edges, from the root line to the tip's line; the root line joins the "
        "ends of the cuts on both sides (the middle of a straight end, the apex of a round one). w "
        "is the width halfway. Beams are numbered from left to right with their tips up. The "
        "compliance is S = L³ / (3 E I), I = w t³ / 12 (eq 5.10); once bent the sagitta goes with "
        "L², and the clearance changes by what the sagitta loses. ",
        out);
  fprintf(out,
          "The scan does not show the thickness: t is the design's %.6g mm%s. The scan is of the "
          "flat foil, before it is bent.</p>\n",
          design->thickness_mm, design->beams.u_thickness_mm > 0 ? ", its u is in that of S" : "");
}

static void put_free_and_fitted(FILE *out) {
  fputs(
      "<h2>Free and fitted</h2>\n<p class=\"note\">The scan shows the foil free: h, C_loc and its "
      "error are those of the foil on its own circle R0. In the bearing it is pressed against the "
      "sleeve; C_fit (and h_fit in the JSON) is what a bump of the same radius and chord has "
      "there. The springback model predicts a height from R alone (h_m): eq 5.6 with measured X, R "
      "and α would give R0 back, whatever the bump, since α is defined by the crossing with R0."
      "</p>\n",
      out);
}

static fg_status put_picture(fg_context *ctx, FILE *out, const fg_report *report,
                             const fg_measurement *measurement, const fg_foil *foil) {
  fputs("<figure>", out);
  FG_TRY(fg_html_picture(ctx, out, measurement, foil, fg_drawing_magnification(report)));
  fprintf(out, "<figcaption>%s</figcaption></figure>\n",
          fg_foil_view_of(report->design->kind)->legend);
  return FG_OK;
}

void fg_html_residual_figure(FILE *out, const fg_foil *foil, const char *against) {
  fputs("<h2>Residual along the foil</h2>\n<figure>", out);
  fg_html_residuals(out, foil);
  fprintf(out,
          "<figcaption>The midline against %s. Standard deviation %.3g µm, correlation length %.3g "
          "mm.</figcaption></figure>\n",
          against, foil->noise.sd_um, foil->noise.correlation_mm);
}

void fg_details_of_beams(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_limits(out, design, foil);
  fputs("<h2>Beams</h2>\n", out);
  fg_html_part_table(out, design, foil);
  fputs("<h2>Against the design, per beam</h2>\n<figure>", out);
  fg_html_errors(out, design, foil);
  fprintf(out,
          "<figcaption>Edges scatter about their lines by %.3g µm, correlated over %.3g mm."
          "</figcaption></figure>\n",
          foil->noise.sd_um, foil->noise.correlation_mm);
  put_beam_words(out, design);
}

void fg_details_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_limits(out, design, foil);
  fputs("<h2>Bumps</h2>\n", out);
  fg_html_part_table(out, design, foil);
  fg_html_foil_table(out, design, foil);
  char thickness[200];
  fg_thickness_words(design, foil, thickness, sizeof thickness);
  if (thickness[0]) fprintf(out, "<p class=\"note\">Strip thickness: %s.</p>\n", thickness);
  fg_html_thickness_budget(out, design, foil);
  fputs("<h2>Springback error per bump</h2>\n<figure>", out);
  fg_html_errors(out, design, foil);
  fputs("</figure>\n", out);
  fg_html_residual_figure(out, foil, "its fitted circles: lands in blue, bumps in orange");
  put_free_and_fitted(out);
}

static void put_not_judged(FILE *out, const fg_design *design) {
  char names[400];
  if (fg_report_of_bearing(design, names, sizeof names))
    fprintf(out,
            "<p class=\"note\">Not judged here: %s: of a bearing; <code>foilgauge lot</code> "
            "judges it.</p>\n",
            names);
}

static void put_section(FILE *out, const fg_report_outcome *outcome, size_t number) {
  fprintf(out, "<section id=\"part%zu\" class=\"judged %s\">\n", number,
          fg_verdict_word(outcome->verdict));
}

static void put_heading(FILE *out, const fg_report_scan *scan, const fg_foil *foil) {
  fputs("<header><h1>Foil ", out);
  if (scan->name)
    fg_html_name(out, scan->name);
  else
    fprintf(out, "%d", foil->number);
  fputs("</h1>", out);
}

/* Of the headline: what a verdict rests on. */
static void put_traceability(FILE *out, const fg_design *design) {
  fprintf(out, " · traced to: %s", fg_traceability_words[fg_design_traceability(design)]);
}

static void put_judged(FILE *out, const fg_design *design, const fg_report_scan *scan,
                       const fg_foil *foil, const fg_decision *decision) {
  static const fg_verdict told[] = {FG_VERDICT_FAIL, FG_VERDICT_NOT_MEASURED, FG_VERDICT_UNDECIDED};
  put_heading(out, scan, foil);
  if (foil->flags & FG_FOIL_NOT_THIS_DESIGN)
    fputs("<span class=\"verdict not_measured\">Not a foil of this design</span>\n", out);
  else
    fg_html_outcome(out, &decision->outcome);
  fputs("<p>", out);
  fg_html_name(out, fg_html_base_name(scan->measurement->scan));
  fg_foil_view_of(design->kind)->page_heading(foil, out);
  put_traceability(out, design);
  fputs("</p></header>\n", out);
  fg_html_defect(out, design, foil);
  for (size_t i = 0; i < sizeof told / sizeof *told; i++)
    fg_html_reasons(out, decision, told[i]);
  put_not_judged(out, design);
}

/* Writes the error that ended or limits the measurement, above the picture. */
static void put_error(FILE *out, const fg_foil *foil) {
  if (!foil->error[0]) return;
  fputs("<p class=\"next\"><b>Why it is not measured:</b> ", out);
  fg_html_text(out, foil->error);
  fputs("</p>\n", out);
}

static fg_status put_foil_section(fg_context *ctx, FILE *out, const fg_report *report,
                                  const fg_report_scan *scan, const fg_foil *foil) {
  const fg_measurement *measurement = scan->measurement;
  const fg_design *design = report->design;
  char moved[FG_CORRECTION_WORDS], added[FG_CORRECTION_WORDS];
  bool measured = !(foil->flags & FG_FOIL_NOT_MEASURED);
  put_error(out, foil);
  put_flags(out, design, foil);
  fg_correction_moved(&foil->correction, moved, sizeof moved);
  fg_correction_added(&foil->correction, added, sizeof added);
  if (measured) FG_TRY(fg_html_corrected(ctx, out, measurement->model, moved, added));
  fg_html_choices(out, foil);
  if (measured) fg_foil_view_of(design->kind)->tiles(out, design, foil);
  FG_TRY(put_picture(ctx, out, report, measurement, foil));
  if (measured) fg_foil_view_of(design->kind)->details(out, design, foil);
  if (foil == measurement->foils) {
    fg_html_colour_lines(out, measurement);
    fg_html_picture_state(out, measurement);
    fg_html_gauges(out, measurement);
  }
  if (measured) put_uncertainty(out, measurement, foil);
  return put_facts(ctx, out, design, measurement);
}

static fg_status put_foil(fg_context *ctx, FILE *out, const fg_report *report,
                          const fg_report_scan *scan, const fg_foil *foil, size_t number) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, report->design, foil, &decision));
  put_section(out, &decision.outcome, number);
  put_judged(out, report->design, scan, foil, &decision);
  fg_decision_free(&decision);
  FG_TRY(put_foil_section(ctx, out, report, scan, foil));
  fputs("</section>\n", out);
  return FG_OK;
}

static fg_status put_discs_corrected(fg_context *ctx, FILE *out,
                                     const fg_measurement *measurement) {
  char moved[FG_CORRECTION_WORDS] = "", added[FG_CORRECTION_WORDS] = "";
  double max = 0, u = 0;
  for (size_t i = 0; i < measurement->disc_count; i++) {
    const fg_disc *disc = &measurement->discs[i];
    if (fabs(disc->radius_correction_mm) > fabs(max)) max = disc->radius_correction_mm;
    u = fmax(u, disc->u_radius_correction_mm);
  }
  if (measurement->disc_count) {
    fg_text_clip(moved, sizeof moved, "radii by up to %+.3g µm", 1000 * max);
    fg_text_clip(added, sizeof added, "up to %.2g µm to their u", 1000 * u);
  }
  FG_TRY(fg_html_corrected(ctx, out, measurement->model, moved, added));
  if (measurement->disc_count) fg_html_disc_choice(out, &measurement->discs[0]);
  return FG_OK;
}

static fg_status put_discs(fg_context *ctx, FILE *out, const fg_report *report,
                           const fg_report_scan *scan, size_t number) {
  const fg_measurement *measurement = scan->measurement;
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
  put_section(out, &outcome, number);
  fprintf(out, "<header><h1>%zu round feature%s</h1>", measurement->disc_count,
          fg_plural(measurement->disc_count));
  fg_html_verdict(out, outcome.verdict);
  fputs("<p>", out);
  fg_html_name(out, fg_html_base_name(measurement->scan));
  put_traceability(out, report->design);
  fputs("</p></header>\n", out);
  FG_TRY(fg_html_disc_reasons(ctx, out, report->design, measurement));
  put_disc_findings(out, measurement);
  FG_TRY(put_discs_corrected(ctx, out, measurement));
  fg_html_disc_tiles(out, measurement);
  FG_TRY(put_picture(ctx, out, report, measurement, NULL));
  fputs("<h2>Every feature</h2>\n", out);
  fg_html_disc_table(out, report->design, measurement);
  fg_html_colour_lines(out, measurement);
  fg_html_picture_state(out, measurement);
  fg_html_gauges(out, measurement);
  put_uncertainty(out, measurement, NULL);
  FG_TRY(put_facts(ctx, out, report->design, measurement));
  fputs("</section>\n", out);
  return FG_OK;
}

static fg_status put_grid(fg_context *ctx, FILE *out, const fg_report *report,
                          const fg_report_scan *scan, size_t number) {
  const fg_measurement *measurement = scan->measurement;
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
  put_section(out, &outcome, number);
  fputs("<header><h1>A grid</h1><p>", out);
  fg_html_name(out, fg_html_base_name(measurement->scan));
  fputs("</p></header>\n", out);
  fg_html_grid(out, measurement);
  FG_TRY(put_facts(ctx, out, report->design, measurement));
  fputs("</section>\n", out);
  return FG_OK;
}

static void put_no_scan(FILE *out, const fg_report_scan *scan, size_t number) {
  const fg_report_outcome outcome = {.verdict = FG_VERDICT_NOT_MEASURED};
  put_section(out, &outcome, number);
  fputs("<header><h1>", out);
  fg_html_name(out, fg_html_base_name(scan->path));
  fputs("</h1>", out);
  fg_html_verdict(out, FG_VERDICT_NOT_MEASURED);
  fputs("</header>\n<p class=\"next\"><b>Why it is not measured:</b> ", out);
  fg_html_text(out, scan->error);
  fputs("</p>\n</section>\n", out);
}

/* `number`: of the section before, and then of its last. */
static fg_status put_scan(fg_context *ctx, FILE *out, const fg_report *report,
                          const fg_report_scan *scan, size_t *number) {
  const fg_measurement *measurement = scan->measurement;
  if (!measurement) {
    put_no_scan(out, scan, ++*number);
    return FG_OK;
  }
  if (measurement->grid) return put_grid(ctx, out, report, scan, ++*number);
  if (!fg_foil_traits_of(report->design->kind)->is_foil)
    return put_discs(ctx, out, report, scan, ++*number);
  for (size_t i = 0; i < measurement->foil_count; i++)
    FG_TRY(put_foil(ctx, out, report, scan, &measurement->foils[i], ++*number));
  return FG_OK;
}

fg_status fg_report_write_html(fg_context *ctx, const fg_report *report, FILE *out) {
  const fg_report_scan *first = &report->scans[0];
  size_t number = 0;
  fg_html_begin(out, first->name ? first->name : fg_html_base_name(first->path));
  if (report->back) fprintf(out, "<p class=\"back\"><a href=\"%s\">← Lot</a></p>\n", report->back);
  if (fg_html_sections(report) > 1) FG_TRY(fg_html_summary(ctx, out, report));
  for (size_t i = 0; i < report->scan_count; i++)
    FG_TRY(put_scan(ctx, out, report, &report->scans[i], &number));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
