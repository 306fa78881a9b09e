/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: verdict, counts, the worst three and one chart first; then the details. */

#include "page/page.h"
#include "core/file.h"
#include "foilgauge/foil_kind.h"
#include "lot/statistics/dies.h"
#include "report/lot/files.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"
#include "report/measure/scan_model_words.h"
#include "report/provenance.h"

/* Puts the effects that the model does not know well enough to correct. */
static void put_uncorrected(FILE *out, const fg_lot_analysis *analysis) {
  static const struct {
    unsigned flag;
    const char *words, *name;
  } kinds[] = {
      {FG_FOIL_OVERALL_RADIUS_LEFT, "overall radius R0", "overall_radius_not_corrected"},
      {FG_FOIL_RADIUS_LEFT, "bump radii R", "radius_not_corrected"},
      {FG_FOIL_HEIGHT_LEFT, "bump heights h", "height_not_corrected"},
  };
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    size_t left = 0;
    for (size_t i = 0; i < analysis->foil_count; i++)
      left += (analysis->foils[i].foil->flags & kinds[k].flag) != 0;
    if (left)
      fprintf(out,
              "<ul class=\"flags\"><li>Left as measured: the %s of %zu of %zu foils, for the model "
              "would add more error than it removes (flag %s in foils.csv).</li></ul>\n",
              kinds[k].words, left, analysis->foil_count, kinds[k].name);
  }
}

/* Puts the model, its largest correction, and the number of foils beyond its region. */
static fg_status put_correction(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  char moved[FG_CORRECTION_WORDS], added[FG_CORRECTION_WORDS];
  const fg_correction max = fg_lot_correction_largest(analysis);
  size_t beyond = 0;
  fg_correction_moved(&max, moved, sizeof moved);
  fg_correction_added(&max, added, sizeof added);
  FG_TRY(fg_html_corrected(ctx, out, analysis->lot->model, moved, added));
  for (size_t i = 0; i < analysis->foil_count; i++)
    beyond += (analysis->foils[i].foil->flags & FG_FOIL_BEYOND_MODEL_REGION) != 0;
  if (beyond)
    fprintf(out,
            "<ul class=\"flags\"><li>Beyond the region that the scanner&#39;s model was found in: "
            "%zu of "
            "%zu foils; there the correction is not known to hold (flag "
            "beyond_model_region in foils.csv).</li></ul>\n",
            beyond, analysis->foil_count);
  put_uncorrected(out, analysis);
  return FG_OK;
}

static void put_lossy(FILE *out, const fg_lot_analysis *analysis) {
  size_t lossy = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    lossy += (analysis->foils[i].foil->flags & FG_FOIL_LOSSY) != 0;
  if (lossy)
    fprintf(out,
            "<ul class=\"flags\"><li>Of scans that were compressed with loss (JPEG), which moves "
            "edges: "
            "%zu of %zu foils; their uncertainties are wider for it (flag lossy in "
            "foils.csv).</li></ul>\n",
            lossy, analysis->foil_count);
}

static fg_status put_lot_first_screen(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  fputs("<section class=\"part\">\n", out);
  fg_lot_put_heading(out, analysis);
  FG_TRY(put_correction(ctx, out, analysis));
  put_lossy(out, analysis);
  fg_lot_put_counts(out, analysis);
  fg_lot_put_worst(out, analysis);
  fg_lot_put_leading(out, analysis);
  fputs("</section>\n", out);
  return FG_OK;
}

static void put_failed_scans(FILE *out, const fg_lot_analysis *analysis) {
  size_t told = 0;
  if (!analysis->failed_scans) return;
  fprintf(out, "<section class=\"part\">\n<h1>Scans that could not be measured: %zu</h1>\n<ul>\n",
          analysis->failed_scans);
  for (size_t i = 0; i < analysis->lot->manifest.items && told < FG_LOT_FOIL_ROWS_MAX; i++) {
    if (!analysis->lot->records[i].error) continue;
    told++;
    fputs("<li>", out);
    fg_html_text(out, analysis->lot->records[i].error);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
  if (told < analysis->failed_scans) fputs("<p class=\"note\">The rest: foils.csv.</p>\n", out);
  fputs("</section>\n", out);
}

static void put_where_pages_are(FILE *out, const fg_lot_analysis *analysis) {
  size_t without = 0, with = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    bool there = analysis->pages && analysis->pages[analysis->foils[i].item];
    with += there;
    without += !there;
  }
  fputs("<p class=\"note\">A scan&#39;s name leads to the scan", out);
  if (with)
    fprintf(out, ", a foil&#39;s to its page: picture%s, and every value",
            analysis->parts == FG_QUANTITY_OF_BEAM ? "" : " with circles and residuals");
  if (with && without) fputs("; where it has none, to its line here", out);
  if (without)
    fputs(". The page of a foil that has none: <code>foilgauge measure SCAN --design … --html "
          "PAGE.html</code>, or the lot again with <code>--resume --pages all</code>",
          out);
  fputs(".</p>\n", out);
}

static void put_foil_list(FILE *out, const fg_lot_analysis *analysis) {
  size_t rows = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    rows += analysis->foils[i].row;
  fputs("<section class=\"part\">\n<h1>Foils</h1>\n", out);
  fg_lot_put_foil_table(out, analysis);
  if (rows < analysis->foil_count)
    fprintf(out,
            "<p class=\"note\">%zu of %zu, those that do not pass first; all: foils.csv.</p>\n",
            rows, analysis->foil_count);
  put_where_pages_are(out, analysis);
  fputs("</section>\n", out);
}

static fg_status put_lot_provenance(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  char scale[FG_SCALE_WORDS];
  fg_scale_words(analysis->lot->model, &analysis->lot->settings.design.calibration, scale,
                 sizeof scale);
  const fg_lot *lot = analysis->lot;
  fg_provenance from = {.version = lot->head.version,
                        .design = &lot->settings.design,
                        .of_scans = true,
                        .model = lot->model};
  fg_provenance_include_date(&from, analysis->date.first);
  fg_provenance_include_date(&from, analysis->date.last);
  fprintf(out,
          "<section class=\"part\">\n<h1>Where it comes from</h1>\n<dl "
          "class=\"facts\"><dt>Recipe, SHA-256</dt><dd translate=\"no\">%s</dd><dt>Manifest, "
          "SHA-256</dt><dd translate=\"no\">%s"
          "</dd>\n",
          lot->head.recipe_sha256, lot->head.manifest_sha256);
  FG_TRY(fg_html_provenance(ctx, out, &from));
  fputs("</dl>\n<p class=\"note\">", out);
  fg_html_text(out, scale);
  fprintf(
      out,
      " A value passes when value ± U lies inside its tolerance "
      "(U = 2 u, about 95 %%), fails when it lies outside, and cannot be told when a limit runs "
      "through it. All numbers: lot.json, foils.csv, %s; for quality systems "
      "results.qif and results.dfq.</p>\n</section>\n",
      analysis->parts == FG_QUANTITY_OF_BEAM ? "beams.csv" : "bumps.csv, bearings.csv");
  return FG_OK;
}

fg_status fg_lot_write_page(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  fg_html_begin(out, analysis->lot->settings.name);
  FG_TRY(put_lot_first_screen(ctx, out, analysis));
  put_failed_scans(out, analysis);
  fg_lot_put_quantities(out, analysis);
  if (fg_foil_kind_has_bumps(analysis->lot->settings.design.kind)) {
    fg_lot_put_springback(out, analysis);
    fg_lot_put_dies(out, analysis);
    fg_lot_put_stiffness(out, analysis);
    fg_lot_put_bearings(out, analysis);
    fg_lot_put_assembly(out, analysis);
    fg_lot_put_film(out, analysis);
  } else if (analysis->parts == FG_QUANTITY_OF_BEAM) {
    fg_lot_put_beams(out, analysis);
  } else {
    fg_lot_put_arcs(out, analysis);
  }
  fg_lot_put_comparisons(out, analysis);
  fg_lot_put_gauge(out, analysis);
  put_foil_list(out, analysis);
  FG_TRY(put_lot_provenance(ctx, out, analysis));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the lot's page");
}
