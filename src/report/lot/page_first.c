/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: its first screen with verdict and process, counts, the worst three, and one
 * chart. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/spread.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/tile.h"
#include "page/verdict.h"
#include "report/doe/words.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"
#include "report/value_words.h"

static fg_tile make_count_tile(const char *title, size_t count, fg_tile_look look,
                               const char *small) {
  return (fg_tile){title, .value = (double)count, .look = look, .small = small};
}

/* Makes the tile of a verdict's count, which is news only where there are some. */
static fg_tile make_verdict_tile(const char *title, size_t count, fg_tile_look look) {
  return make_count_tile(title, count, count ? look : FG_TILE_PLAIN, NULL);
}

static bool foils_are_judged(const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  return design->tolerance_count > fg_report_of_bearing(design, NULL, 0);
}

/* A foil lies far from the others beyond FAR_SD robust standard deviations and FAR_SHARE of their
 * median bump radius: foils of one product scatter by less than a tenth of that share. */
#define FAR_SD    8.0
#define FAR_SHARE 0.03
enum { FAR_FOILS_MIN = 5 };

static double mean_bump_radius(const fg_foil *foil) {
  double sum = 0;
  size_t count = 0;
  for (size_t k = 0; fg_foil_is_measured(foil) && k < foil->bump_count; k++) {
    if (!fg_lot_bump_counts(foil, &foil->bumps[k])) continue;
    sum += foil->bumps[k].radius_mm;
    count++;
  }
  return count ? sum / (double)count : NAN;
}

/* Counts the foils far from the others, which may be of another product. */
static size_t count_far_foils(const fg_lot_analysis *analysis) {
  size_t foils = 0, far = 0;
  double *radius = malloc((analysis->foil_count + 1) * sizeof *radius);
  double *work = malloc((analysis->foil_count + 1) * sizeof *work);
  for (size_t i = 0; radius && work && i < analysis->foil_count; i++) {
    double mean = mean_bump_radius(analysis->foils[i].foil);
    if (isfinite(mean)) radius[foils++] = mean;
  }
  if (foils >= FAR_FOILS_MIN) {
    memcpy(work, radius, foils * sizeof *work);
    double median = fg_median(work, foils);
    for (size_t i = 0; i < foils; i++)
      work[i] = fabs(radius[i] - median);
    double limit = fmax(FAR_SD * fg_robust_sd(work, foils), FAR_SHARE * median);
    for (size_t i = 0; i < foils; i++)
      far += fabs(radius[i] - median) > limit;
  }
  free(radius);
  free(work);
  return far;
}

static void put_scan_tiles(FILE *out, const fg_lot_analysis *analysis) {
  size_t failed = analysis->failed_scans, scans = analysis->lot->manifest.items;
  size_t repeats = analysis->repeated.count, far = count_far_foils(analysis);
  bool parts = !fg_foil_traits_of(analysis->lot->settings.design.kind)->is_plain_strip;
  const fg_lot_words *words = fg_lot_words_of(analysis);
  const fg_tile tiles[] = {
      make_count_tile("Scans", scans, FG_TILE_PLAIN, failed ? "" : "all could be measured"),
      make_count_tile(failed ? "Scans not measured" : NULL, failed, FG_TILE_OPEN, "named below"),
      make_count_tile(repeats ? "of them there twice" : NULL, repeats, FG_TILE_OPEN,
                      "the same bytes under another name"),
      make_count_tile("Foils on them", analysis->foil_count, FG_TILE_PLAIN, ""),
      make_count_tile(analysis->scanned_again ? "Different foils" : NULL,
                      analysis->foil_count - analysis->scanned_again, FG_TILE_PLAIN,
                      "the others are further scans of them"),
      make_count_tile(far ? "Foils far from the others" : NULL, far, FG_TILE_OPEN,
                      "of another product? They are in all statistics of this page"),
      make_count_tile(parts ? words->counted : NULL, analysis->part_count, FG_TILE_PLAIN, ""),
      make_count_tile(parts && analysis->left_out ? words->damaged : NULL, analysis->left_out,
                      FG_TILE_OPEN, "judged, but in no statistics of this page"),
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_verdict_tiles(FILE *out, const fg_lot_analysis *analysis) {
  const size_t *by = analysis->by_verdict;
  bool judged = foils_are_judged(analysis);
  size_t undecided = by[FG_VERDICT_UNDECIDED], not_measured = by[FG_VERDICT_NOT_MEASURED];
  if (!judged && !by[FG_VERDICT_FAIL] && !not_measured) return;
  fg_tile tiles[] = {
      make_verdict_tile(judged ? "Foils pass" : NULL, by[FG_VERDICT_PASS], FG_TILE_GOOD),
      make_verdict_tile("Foils fail", by[FG_VERDICT_FAIL], FG_TILE_BAD),
      make_verdict_tile(judged ? "Foils, cannot tell" : NULL, undecided, FG_TILE_OPEN),
      make_verdict_tile(not_measured ? "Foils not measured" : NULL, not_measured, FG_TILE_OPEN),
  };
  if (undecided)
    tiles[2].small = fg_design_may_judge(&analysis->lot->settings.design)
                         ? "a limit lies within ± U"
                         : "the scanner's scale is not known";
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_bearing_tiles(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  const size_t *by = analysis->bearings_by_verdict;
  size_t undecided = by[FG_VERDICT_UNDECIDED], not_measured = by[FG_VERDICT_NOT_MEASURED];
  if (!fg_report_of_bearing(&lot->settings.design, NULL, 0)) return;
  bool assumed = fg_manifest_column(&lot->manifest, lot->settings.bearing_column) == FG_NO_COLUMN;
  const fg_tile tiles[] = {
      make_count_tile("Bearings", analysis->bearing_count, FG_TILE_PLAIN,
                      assumed ? "foils in a row" : "as the manifest says"),
      make_verdict_tile("Bearings pass", by[FG_VERDICT_PASS], FG_TILE_GOOD),
      make_verdict_tile("Bearings fail", by[FG_VERDICT_FAIL], FG_TILE_BAD),
      make_verdict_tile(undecided ? "Bearings, cannot tell" : NULL, undecided, FG_TILE_OPEN),
      make_verdict_tile(not_measured ? "Bearings not measured" : NULL, not_measured, FG_TILE_OPEN),
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

void fg_lot_put_counts(FILE *out, const fg_lot_analysis *analysis) {
  put_scan_tiles(out, analysis);
  put_verdict_tiles(out, analysis);
  put_bearing_tiles(out, analysis);
}

/* Puts the state of the process beside the verdict: passing foils tell nothing of tomorrow's. */
static void put_process(FILE *out, const fg_lot_process *process) {
  size_t open = process->unstable - process->explained;
  if (!process->watched)
    fputs("<span class=\"verdict process\">Process: too few foils to tell</span>", out);
  else if (!process->unstable)
    fputs("<span class=\"verdict pass process\">Process stable</span>", out);
  else if (!open)
    fputs("<span class=\"verdict cannot_tell process\">Process: groups differ</span>", out);
  else
    fprintf(out,
            "<span class=\"verdict cannot_tell process\">Process not stable: %zu of %zu "
            "quantities</span>",
            open, process->watched);
}

/* Puts the foils of signals: " (foils A, B and 3 more)". */
static void put_signal_counts(FILE *out, const fg_lot_analysis *analysis,
                              const fg_lot_quantity *quantity) {
  enum { NAMED = 8 };
  size_t told = 0, foil = 0, foils = quantity->chart.signals;
  if (!foils) return;
  fputs(foils == 1 ? " (foil " : " (foils ", out);
  for (size_t i = 0; i < quantity->chart.count && told < NAMED; i++, foil++) {
    while (!quantity->size[foil])
      foil++;
    if (!quantity->chart.point[i].rules) continue;
    if (told) fputs(told + 1 == foils ? " and " : ", ", out);
    fg_lot_put_foil_link(out, analysis, &analysis->foils[foil]);
    told++;
  }
  if (told < foils) fprintf(out, " and %zu more", foils - told);
  fputs(")", out);
}

/* Puts a change in the unit that people read: µm for mm. */
static void put_trend_change(FILE *out, const fg_quantity *row, double change, double u) {
  bool fine = !strcmp(row->unit, "mm");
  char words[80];
  fg_scan_loop_value_words((fine ? 1000 : 1) * fabs(change), (fine ? 1000 : 1) * u, words,
                           sizeof words);
  fprintf(out, "%s %s", words, fine ? "µm" : row->unit);
}

/* Puts a trend: ": in the order of the foils it rises by 2.03 ± 0.31 µm a foil, 28.4 ± 4.3 µm from
 * the first to the last (p = 0.0002); without this trend no signal is left." U is of 95 %. */
static void put_trend(FILE *out, const fg_lot_quantity *quantity) {
  const fg_lot_trend *trend = &quantity->trend;
  double u = trend->u_per_foil * fg_distribution_t_quantile(0.975, trend->dof) / FG_COVERAGE_FACTOR;
  double steps = (double)(trend->foils - 1);
  char p_value[16];
  fprintf(out, ": in the order of the foils it %s by ", trend->per_foil < 0 ? "falls" : "rises");
  put_trend_change(out, quantity->row, trend->per_foil, u);
  fputs(" a foil, ", out);
  put_trend_change(out, quantity->row, steps * trend->per_foil, steps * u);
  fg_p_value_text(p_value, trend->p_value);
  fputs(" from the first to the last (p ", out);
  fg_html_text(out, *p_value == '<' ? "" : "= ");
  fg_html_text(out, p_value);
  fputs("); without this trend ", out);
  if (trend->signals_left)
    fprintf(out, "%zu of the signals %s left.</li>\n", trend->signals_left,
            trend->signals_left == 1 ? "is" : "are");
  else
    fputs("no signal is left.</li>\n", out);
}

/* Puts a cause: "The signals of bump radius come from the column die: ... each by itself shows
 * none." */
static void put_quantity_cause(FILE *out, const fg_lot_analysis *analysis,
                               const fg_lot_quantity *quantity) {
  const fg_lot_cause *cause = &quantity->cause;
  fprintf(out, "<li>%zu signal%s of the %s", quantity->chart.signals,
          quantity->chart.signals == 1 ? "" : "s", quantity->row->words);
  if (fg_lot_is_trend(quantity)) {
    put_signal_counts(out, analysis, quantity);
    put_trend(out, quantity);
    return;
  }
  if (cause->column == FG_NO_COLUMN) {
    put_signal_counts(out, analysis, quantity);
    fprintf(out, ": no group of foils explains %s.</li>\n",
            quantity->chart.signals == 1 ? "it" : "them");
    return;
  }
  fg_lot_put_cause(out, analysis, quantity);
  fputs("</li>\n", out);
}

void fg_lot_put_cause(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity) {
  const fg_lot_cause *cause = &quantity->cause;
  const char *separator = "";
  if (cause->column == FG_NO_COLUMN) return;
  fputs(" come from the groups of the column <b>", out);
  fg_html_name(out, analysis->lot->manifest.name[cause->column]);
  fprintf(out, "</b>%s: ", cause->in_turn ? ", whose foils lie in turn" : "");
  for (size_t g = 0; g < cause->groups; g++) {
    fputs(separator, out);
    fg_html_name(out, cause->name[g]);
    fputs(" has a mean of ", out);
    fg_lot_put_value(out, quantity->row, cause->mean[g]);
    fprintf(out, " %s", quantity->row->unit);
    separator = g + 2 == cause->groups ? " and " : ", ";
  }
  if (cause->signals_left)
    fprintf(out, "; with all groups moved to one mean %zu of them %s left.", cause->signals_left,
            cause->signals_left == 1 ? "is" : "are");
  else
    fputs("; with all groups moved to one mean no signal is left.", out);
}

static void put_causes(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->process.unstable) return;
  fputs("<ul class=\"flags\">\n", out);
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_quantity *quantity = &analysis->quantities[i];
    if (!fg_lot_is_watched(analysis, quantity) || quantity->stable) continue;
    if (quantity->chart.signals) put_quantity_cause(out, analysis, quantity);
    if (quantity->has_subgroups && quantity->deviations.signals)
      fprintf(out, "<li>%zu signal%s of the spread of the %s within foils.</li>\n",
              quantity->deviations.signals, quantity->deviations.signals == 1 ? "" : "s",
              quantity->row->words);
  }
  fputs("</ul>\n", out);
}

/* Says why no foil is judged by its values, and what to do. */
static void put_unknown_scale(FILE *out, const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  if (!design->tolerance_count || fg_design_may_judge(design)) return;
  fputs("<p class=\"next\"><b>Cannot tell, as nothing is known of the scanner&#39;s scale.</b> ",
        out);
  fg_html_text(out, fg_traceability_cure);
  fputs("</p>\n", out);
}

void fg_lot_put_heading(FILE *out, const fg_lot_analysis *analysis) {
  fputs("<header><h1>", out);
  fg_html_name(out, analysis->lot->settings.name);
  fputs("</h1>", out);
  fg_html_outcome(out, &analysis->outcome);
  put_process(out, &analysis->process);
  fprintf(out, "<p>%zu foil%s of %zu scan%s, design ", analysis->foil_count,
          fg_plural(analysis->foil_count), analysis->lot->manifest.items,
          fg_plural(analysis->lot->manifest.items));
  fg_html_name(out, analysis->lot->settings.design.name);
  fprintf(out, " · traced to: %s</p></header>\n",
          fg_traceability_words[fg_design_traceability(&analysis->lot->settings.design)]);
  put_unknown_scale(out, analysis);
  put_causes(out, analysis);
}

void fg_lot_put_worst(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->worst[0]) return;
  fputs("<h2>The worst three</h2>\n", out);
  fg_lot_put_worst_table(out, analysis);
  if (!foils_are_judged(analysis))
    fputs("<p class=\"note\">No tolerance is stated: these lie farthest from the lot's "
          "mean.</p>\n",
          out);
}

void fg_lot_put_leading(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_quantity *leading = fg_lot_leading_quantity(analysis);
  if (!leading || !leading->places) return;
  fprintf(out, "<h2>Every %s</h2>\n<figure>", leading->row->words);
  fg_lot_plot_places(out, analysis, leading, NULL);
  fputs("<figcaption>", out);
  fg_lot_put_places_key(out, analysis, leading);
  if (analysis->left_out) fprintf(out, " %s are not drawn.", fg_lot_words_of(analysis)->damaged);
  fputs("</figcaption></figure>\n", out);
}
