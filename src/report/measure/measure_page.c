/* The page: for every foil its verdict, key numbers and picture first, then tables and plots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "report/correction_words.h"
#include "report/measure/measure_page_tables.h"
#include "report/measure/scan_model_words.h"
#include "report/measure/uncertainty_budget.h"

static const char *base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash && slash[1] ? slash + 1 : path;
}

static void put_tile(FILE *out, fg_quantity_owner owner, const char *name, const char *title,
                     const void *object) {
  const fg_quantity *row = fg_quantity_find(owner, name);
  double value = fg_quantity_value(row, object), u = fg_quantity_uncertainty(row, object);
  int decimals = fg_report_decimals(row, u);
  fprintf(out, "<div><dt>%s</dt><dd>", title);
  if (isfinite(value))
    fprintf(out, "%s%.*f %s", value < 0 ? "−" : "", decimals, fabs(value), row->unit);
  else
    fputs("–", out);
  if (isfinite(u)) fprintf(out, "<small>± %.*f</small>", decimals, FG_COVERAGE_FACTOR * u);
  fputs("</dd></div>\n", out);
}

/* Mean over the bumps, with their spread as a standard deviation: it says more than one bump. */
static void put_mean_tile(FILE *out, const fg_foil *foil, const char *name, const char *title) {
  const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_BUMP, name);
  double sum = 0, squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < foil->bump_count; i++) {
    double value = fg_quantity_value(row, &foil->bumps[i]);
    if (!isfinite(value)) continue;
    count++;
    double step = value - sum;
    sum += step / (double)count; /* the running mean */
    squares += step * (value - sum);
  }
  if (count == 0) return;
  fprintf(out, "<div><dt>%s</dt><dd>%.*f %s", title, row->decimals, sum, row->unit);
  if (count > 1)
    fprintf(out, "<small>s = %.*f, n = %zu</small>", row->decimals,
            sqrt(squares / (double)(count - 1)), count);
  fputs("</dd></div>\n", out);
}

static void put_arc_tiles(FILE *out, const fg_foil *foil) {
  fputs("<dl class=\"tiles\">\n", out);
  put_tile(out, FG_QUANTITY_OF_FOIL, "overall.radius_mm", "Radius", foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "overall.springback_error_pct", "Springback of the radius",
           foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "arc.subtended_angle_deg", "Angle between the ends", foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "arc.subtended_angle_error_pct", "Angle against the design",
           foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "arc.length_mm", "Length", foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "thickness_mm", "Thickness", foil);
  fputs("</dl>\n", out);
}

static void put_tiles(FILE *out, const fg_foil *foil) {
  fputs("<dl class=\"tiles\">\n", out);
  put_tile(out, FG_QUANTITY_OF_FOIL, "overall.radius_mm", "Overall radius", foil);
  put_tile(out, FG_QUANTITY_OF_FOIL, "overall.springback_error_pct", "Overall springback", foil);
  put_mean_tile(out, foil, "radius_mm", "Bump radius, mean");
  put_mean_tile(out, foil, "height_mm", "Bump height, mean");
  put_mean_tile(out, foil, "clearance_mm", "Clearance, free, mean");
  put_mean_tile(out, foil, "clearance_fitted_mm", "Clearance, fitted, mean");
  put_tile(out, FG_QUANTITY_OF_FOIL, "thickness_mm", "Thickness", foil);
  fputs("</dl>\n", out);
}

static void put_flags(FILE *out, const fg_design *design, const fg_foil *foil) {
  unsigned flags = fg_foil_flags_told(design, foil);
  if (!flags) return;
  fputs("<ul class=\"flags\">\n", out);
  for (const fg_flag_words *words = fg_foil_flag_words(); words->name; words++)
    if (flags & words->flag) fprintf(out, "<li>%s</li>\n", words->plain);
  fputs("</ul>\n", out);
}

static fg_status put_facts(fg_context *ctx, FILE *out, const fg_design *design,
                           const fg_measurement *measurement) {
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\">\n<dt>Scan</dt><dd>", out);
  fg_html_text(out, measurement->scan);
  fprintf(out, "</dd>\n<dt>Pixels</dt><dd>%lld × %lld, %d bit</dd>\n",
          (long long)measurement->width_px, (long long)measurement->height_px,
          measurement->bit_depth);
  fprintf(out, "<dt>Resolution</dt><dd>%.8g × %.8g dpi", measurement->dpi[0], measurement->dpi[1]);
  if (isfinite(measurement->dpi_file[0]))
    fprintf(out, " (the file says %.8g × %.8g)", measurement->dpi_file[0],
            measurement->dpi_file[1]);
  fputs("</dd>\n<dt>SHA-256</dt><dd>", out);
  fg_html_text(out, measurement->sha256);
  fputs("</dd>\n<dt>Design</dt><dd>", out);
  fg_html_text(out, design->name);
  fprintf(out, " (%s)</dd>\n", fg_form_word(design->form));
  FG_TRY(fg_html_model_facts(ctx, out, measurement->model));
  fputs("<dt>Program</dt><dd>foilgauge " FOILGAUGE_VERSION "</dd>\n</dl>\n", out);
  return FG_OK;
}

static void put_uncertainty(FILE *out, const fg_measurement *measurement, const fg_foil *foil) {
  char scale[FG_SCALE_WORDS];
  fg_scale_words(measurement->model, &measurement->design.calibration, scale, sizeof scale);
  fputs("<h2>What ± means</h2>\n<p class=\"note\">± is the expanded uncertainty U = 2 u (coverage "
        "factor k = 2, about 95 %). u comes from the residuals with their correlation along the "
        "edge and from what the two edges say against each other. ",
        out);
  fg_html_text(out, scale);
  fputs(" A value passes when value ± U lies inside its tolerance, fails when "
        "it lies outside, and cannot be told when a limit runs through it. s is the standard "
        "deviation over the n bumps.</p>\n",
        out);
  fg_html_uncertainty_budget(out, measurement, foil);
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

static fg_status put_picture(fg_context *ctx, FILE *out, const fg_measurement *measurement,
                             const fg_foil *foil) {
  fputs("<figure>", out);
  FG_TRY(fg_html_picture(ctx, out, measurement, foil));
  if (measurement->design.form == FG_FORM_ARC) {
    fputs("<figcaption>Blue, dashed: the circle; orange: the cuts at the ends, with their "
          "directions from the centre. Magenta: "
          "residuals, magnified as the scale says.</figcaption></figure>\n",
          out);
    return FG_OK;
  }
  fputs("<figcaption>Orange: bump circles, solid where the fit used them. Blue, dashed: overall "
        "circle. Magenta: residuals, magnified as the scale says.</figcaption></figure>\n",
        out);
  return FG_OK;
}

static void put_residuals(FILE *out, const fg_foil *foil, const char *against) {
  fputs("<h2>Residual along the foil</h2>\n<figure>", out);
  fg_html_residuals(out, foil);
  fprintf(out,
          "<figcaption>The midline against %s. Standard deviation %.3g µm, correlation length %.3g "
          "mm.</figcaption></figure>\n",
          against, foil->noise_um, foil->correlation_mm);
}

static void put_arc_details(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_foil_table(out, design, foil);
  put_residuals(out, foil, "its circle");
  fputs("<h2>What the errors mean</h2>\n<p class=\"note\">Springback of the radius is 100 (design "
        "− actual) / design, that of the angle 100 (actual − design) / design: of a foil that has "
        "opened both are below 0. The angle is that between the two cuts, seen from the centre."
        "</p>\n",
        out);
}

static void put_foil_details(FILE *out, const fg_design *design, const fg_foil *foil) {
  fputs("<h2>Bumps</h2>\n", out);
  fg_html_bump_table(out, design, foil);
  fg_html_foil_table(out, design, foil);
  char thickness[200];
  fg_thickness_words(design, foil, thickness, sizeof thickness);
  if (thickness[0]) fprintf(out, "<p class=\"note\">Strip thickness: %s.</p>\n", thickness);
  fputs("<h2>Springback error per bump</h2>\n<figure>", out);
  fg_html_springback(out, foil);
  fputs("</figure>\n", out);
  put_residuals(out, foil, "its fitted circles: lands in blue, bumps in orange");
}

/* "Out of tolerance (3 values): bump height 1, 8; bump angle 1." Judgements of one tolerance are
 * neighbours. Bumps that are missing are the defect's to tell. */
static void put_reasons(FILE *out, const fg_decision *decision, fg_verdict verdict) {
  const fg_judgement *list = decision->judgements;
  const fg_tolerance *last = NULL;
  size_t values = 0;
  for (size_t i = 0; i < decision->count; i++)
    values += list[i].verdict == verdict && !list[i].missing;
  for (size_t i = 0; i < decision->count; i++) {
    if (list[i].verdict != verdict || list[i].missing) continue;
    if (!last)
      fprintf(out, "<p class=\"reasons\"><b>%s (%zu %s):</b> ", fg_html_verdict_title(verdict),
              values, values == 1 ? "value" : "values");
    if (list[i].tolerance != last) {
      fprintf(out, "%s%s", last ? "; " : "", list[i].row->words);
      if (list[i].number) fprintf(out, " %d", list[i].number);
    } else {
      fprintf(out, ", %d", list[i].number);
    }
    last = list[i].tolerance;
  }
  if (last) fputs(".</p>\n", out);
}

static void put_defect(FILE *out, const fg_design *design, const fg_foil *foil) {
  char words[200];
  if (fg_foil_defect(design, foil, words, sizeof words))
    fprintf(out, "<p class=\"reasons\"><b>Rejected:</b> %s.</p>\n", words);
}

static void put_not_judged(FILE *out, const fg_design *design) {
  char names[400];
  if (fg_report_of_bearing(design, names, sizeof names))
    fprintf(out,
            "<p class=\"note\">Not judged here: %s: of a bearing; <code>foilgauge lot</code> "
            "judges it.</p>\n",
            names);
}

static void put_heading(FILE *out, const fg_report_scan *scan, const fg_foil *foil) {
  fputs("<header><h1>Foil ", out);
  if (scan->name)
    fg_html_text(out, scan->name);
  else
    fprintf(out, "%d", foil->number);
  fputs("</h1>", out);
}

static fg_status put_judged(fg_context *ctx, FILE *out, const fg_design *design,
                            const fg_report_scan *scan, const fg_foil *foil) {
  static const fg_verdict told[] = {FG_VERDICT_FAIL, FG_VERDICT_NOT_MEASURED, FG_VERDICT_UNDECIDED};
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, design, foil, &decision));
  put_heading(out, scan, foil);
  if (foil->flags & FG_FOIL_NOT_THIS_DESIGN)
    fputs("<span class=\"verdict not_measured\">Not a foil of this design</span>\n", out);
  else
    fg_html_outcome(out, &decision.outcome);
  fputs("<p>", out);
  fg_html_text(out, base_name(scan->measurement->scan));
  if (design->form == FG_FORM_ARC)
    fputs(" · a plain strip", out);
  else if (!(foil->flags & FG_FOIL_NOT_MEASURED))
    fprintf(out, " · %zu bumps, %s", foil->bump_count, fg_orientation_word(foil->orientation));
  fputs("</p></header>\n", out);
  put_defect(out, design, foil);
  for (size_t i = 0; i < sizeof told / sizeof *told; i++)
    put_reasons(out, &decision, told[i]);
  put_not_judged(out, design);
  fg_decision_free(&decision);
  return FG_OK;
}

static fg_status put_foil(fg_context *ctx, FILE *out, const fg_design *design,
                          const fg_report_scan *scan, const fg_foil *foil) {
  const fg_measurement *measurement = scan->measurement;
  char moved[FG_CORRECTION_WORDS], added[FG_CORRECTION_WORDS];
  bool measured = !(foil->flags & FG_FOIL_NOT_MEASURED);
  fputs("<section>\n", out);
  FG_TRY(put_judged(ctx, out, design, scan, foil));
  fg_correction_moved(&foil->correction, moved, sizeof moved);
  fg_correction_added(&foil->correction, added, sizeof added);
  if (measured) FG_TRY(fg_html_corrected(ctx, out, measurement->model, moved, added));
  fg_html_choices(out, foil);
  if (foil->error[0]) {
    fputs("<p class=\"reasons\">", out);
    fg_html_text(out, foil->error);
    fputs("</p>\n", out);
  }
  bool arc = design->form == FG_FORM_ARC;
  if (measured) (arc ? put_arc_tiles : put_tiles)(out, foil);
  FG_TRY(put_picture(ctx, out, measurement, foil));
  put_flags(out, design, foil);
  if (measured) (arc ? put_arc_details : put_foil_details)(out, design, foil);
  if (measured && !arc) put_free_and_fitted(out);
  if (measured) put_uncertainty(out, measurement, foil);
  FG_TRY(put_facts(ctx, out, design, measurement));
  fputs("</section>\n", out);
  return FG_OK;
}

static fg_status put_discs_corrected(fg_context *ctx, FILE *out,
                                     const fg_measurement *measurement) {
  char moved[FG_CORRECTION_WORDS] = "", added[FG_CORRECTION_WORDS] = "";
  double most = 0, u = 0;
  for (size_t i = 0; i < measurement->disc_count; i++) {
    const fg_disc *disc = &measurement->discs[i];
    if (fabs(disc->radius_correction_mm) > fabs(most)) most = disc->radius_correction_mm;
    u = fmax(u, disc->u_radius_correction_mm);
  }
  if (measurement->disc_count) {
    fg_text_clip(moved, sizeof moved, "radii by up to %+.3g µm", 1000 * most);
    fg_text_clip(added, sizeof added, "up to %.2g µm to their u", 1000 * u);
  }
  FG_TRY(fg_html_corrected(ctx, out, measurement->model, moved, added));
  if (measurement->disc_count) fg_html_disc_choice(out, &measurement->discs[0]);
  return FG_OK;
}

static fg_status put_discs(fg_context *ctx, FILE *out, const fg_report *report,
                           const fg_report_scan *scan) {
  const fg_measurement *measurement = scan->measurement;
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
  fprintf(out, "<section>\n<header><h1>%zu round features</h1>", measurement->disc_count);
  fg_html_verdict(out, outcome.verdict);
  fputs("<p>", out);
  fg_html_text(out, base_name(measurement->scan));
  fputs("</p></header>\n", out);
  FG_TRY(put_discs_corrected(ctx, out, measurement));
  FG_TRY(put_picture(ctx, out, measurement, NULL));
  fg_html_disc_table(out, report->design, measurement);
  put_uncertainty(out, measurement, NULL);
  FG_TRY(put_facts(ctx, out, report->design, measurement));
  fputs("</section>\n", out);
  return FG_OK;
}

static fg_status put_scan(fg_context *ctx, FILE *out, const fg_report *report,
                          const fg_report_scan *scan) {
  const fg_measurement *measurement = scan->measurement;
  if (!measurement) {
    fputs("<section>\n<header><h1>", out);
    fg_html_text(out, base_name(scan->path));
    fputs("</h1>", out);
    fg_html_verdict(out, FG_VERDICT_NOT_MEASURED);
    fputs("</header>\n<p>", out);
    fg_html_text(out, scan->error);
    fputs("</p>\n</section>\n", out);
    return FG_OK;
  }
  if (report->design->form == FG_FORM_DISCS) return put_discs(ctx, out, report, scan);
  for (size_t i = 0; i < measurement->foil_count; i++)
    FG_TRY(put_foil(ctx, out, report->design, scan, &measurement->foils[i]));
  return FG_OK;
}

fg_status fg_report_write_html(fg_context *ctx, const fg_report *report, FILE *out) {
  const fg_report_scan *first = &report->scans[0];
  fg_html_begin(out, first->name ? first->name : base_name(first->path));
  for (size_t i = 0; i < report->scan_count; i++)
    FG_TRY(put_scan(ctx, out, report, &report->scans[i]));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
