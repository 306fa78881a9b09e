/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page: a bearing per section; clearances over the azimuths, then loops and stiffness. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/load_report.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "page/verdict.h"
#include "report/load_test/members.h"
#include "report/load_test/plots.h"
#include "report/provenance.h"

/* Azimuths of a bearing that are drawn with their loops, at most; all are in the table. */
enum { LOOPS_MAX = 24 };

/* The tail of a distribution is not known below. */
static const double p_min = 1e-12;

static size_t count_flagged(const fg_load_test *test, size_t bearing, unsigned flag) {
  size_t count = 0;
  for (size_t i = 0; i < test->direction_count; i++)
    count += test->directions[i].bearing == bearing && (test->directions[i].flags & flag);
  return count;
}

static fg_tile make_load_tile(const char *title, const fg_load_value *v, double factor,
                              int decimals, const char *unit, const char *small) {
  return (fg_tile){
      title,        .value = factor * v->value, .u = factor * v->u, .decimals = decimals,
      .unit = unit, .u_words = FG_TILE_U_IS_2U, .small = small,     .unknown = "not known"};
}

/* Makes the tile of a clearance in mm, shown in µm. Where foils press the rotor all around there
 * is none. */
static fg_tile make_clearance_tile(const fg_load_test *test, size_t bearing, const char *title,
                                   const fg_load_value *v, const char *small) {
  fg_tile tile = make_load_tile(title, v, 1000, 1, "µm", small);
  if (count_flagged(test, bearing, FG_LOAD_NO_GAP) < test->bearings[bearing].directions)
    return tile;
  tile.value = NAN;
  tile.unknown = "no gap";
  return tile;
}

static void put_load_tiles(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  bool lower_bound = count_flagged(test, bearing, FG_LOAD_AT_END);
  char min[60] = "", max[60] = "", axis[60], axis_u[60];
  if (isfinite(b->min.value)) {
    snprintf(min, sizeof min, "at %g°", b->min_measured_at_deg);
    snprintf(max, sizeof max, "at %g°", b->max_measured_at_deg);
  }
  bool axis_known = b->axis == FG_LOAD_AXIS_KNOWN;
  snprintf(axis, sizeof axis, "%.1f° and %.1f°", b->min_at_deg, b->min_at_deg + 180);
  snprintf(axis_u, sizeof axis_u, "± %.1f° (U = 2 u), fitted", 2 * b->u_min_at_deg);
  const fg_tile tiles[] = {
      make_clearance_tile(test, bearing, "Smallest clearance", &b->min, min),
      make_clearance_tile(test, bearing, "Largest clearance", &b->max, max),
      make_load_tile("Structural stiffness, mean", &b->stiffness, 1, 0, "N/mm",
                     lower_bound ? "a lower bound" : ""),
      make_load_tile("Radial hysteresis", &b->hysteresis_n, 1, 2, "N", "no preload"),
      {"Smallest clearance at", .text = axis_known ? axis : "–",
       .small = axis_known ? axis_u : fg_load_axis_words(b->axis)},
      make_load_tile(b->break_away.pulls ? "Preload" : NULL, &b->preload_kpa, 1, 2, "kPa", ""),
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_load_table(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_subject list = fg_load_bearing_subject(test, bearing);
  fg_html_table(out, &fg_load_direction_members, &list, fg_load_direction_of_bearing);
}

static void put_loops(FILE *out, const fg_load_test *test, size_t bearing) {
  size_t drawn = 0;
  fputs("<div class=\"panels\">\n", out);
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    if (d->bearing != bearing || drawn++ >= LOOPS_MAX) continue;
    fprintf(out, "<figure><h3>%g°, force</h3>", d->azimuth_deg);
    fg_load_plot_loops(out, test, d);
    fprintf(out, "</figure>\n<figure><h3>%g°, stiffness</h3>", d->azimuth_deg);
    fg_load_plot_stiffness(out, d);
    fputs("</figure>\n", out);
  }
  fputs("</div>\n", out);
  if (drawn > LOOPS_MAX)
    fprintf(out, "<p class=\"note\">The first %d azimuths of %zu are drawn.</p>\n", LOOPS_MAX,
            drawn);
}

static void put_sentences(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  fputs("<ul class=\"words\">\n", out);
  if (isfinite(b->p_value))
    fprintf(out, "<li>The azimuths %s (p %s %.2g).</li>\n",
            b->p_value < 0.01 ? "differ by more than their repeats do"
                              : "do not differ by more than their repeats do",
            b->p_value < p_min ? "&lt;" : "=", fmax(b->p_value, p_min));
  size_t at_end = count_flagged(test, bearing, FG_LOAD_AT_END);
  if (at_end)
    fprintf(
        out,
        "<li>Of %zu of %zu azimuths the stiffness is largest at the last place before the turn: "
        "a foil that hardens is stiffer at the turn and beyond, and K is a lower bound.</li>\n",
        at_end, b->directions);
  if (b->birge > 1.2)
    fprintf(out,
            "<li>The cycles differ by %.1f times what the scatter of the samples says; the "
            "uncertainties are as much larger.</li>\n",
            b->birge);
  if (isfinite(b->hysteresis_n.value))
    fprintf(out,
            "<li>Radial hysteresis: half of what lies between the strokes is %.3f N + %.4f |F|, "
            "friction of the foils and of the rig. Preload does not follow from it%s.</li>\n",
            b->hysteresis_n.value, b->slope,
            b->break_away.pulls ? "" : ": that takes a break-away test");
  if (isfinite(b->noise_n)) {
    fprintf(out, "<li>Noise of a sample: %.3g N, and %.2g µm of displacement", b->noise_n,
            1000 * b->noise_mm);
    if (b->step_mm > b->noise_mm)
      fprintf(out, ", which was recorded in steps of %.3g µm", 1000 * b->step_mm);
    fputs(".</li>\n", out);
  }
  if (b->in_lot && b->unknown_places)
    fprintf(out, "<li>No clearance at %zu place%s of the lot's bearing: predicted without.</li>\n",
            b->unknown_places, fg_plural(b->unknown_places));
  if (test->options.lot && !b->in_lot)
    fputs("<li>The lot has no bearing of this name.</li>\n", out);
  fputs("</ul>\n", out);
}

static void put_break_away(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  const fg_break_away *a = &b->break_away;
  char flags[1200];
  if (!a->pulls) return;
  fprintf(out,
          "<h2>Break-away test</h2>\n<div class=\"panels\"><figure><h3>%zu pull%s, %zu dead "
          "weight%s</h3>",
          a->pulls, fg_plural(a->pulls), a->weights, fg_plural(a->weights));
  fg_load_plot_break_away(out, test, bearing);
  const fg_tile tiles[] = {
      make_load_tile("Friction coefficient", &a->friction, 1, 4, "", ""),
      make_load_tile("Friction without a weight", &a->intercept_n, 1, 3, "N",
                     isfinite(a->rig_n) ? "less the rig's" : ""),
      make_load_tile("Preload", &b->preload_n, 1, 1, "N", ""),
      make_load_tile("over the bore", &b->preload_kpa, 1, 2, "kPa", ""),
  };
  fputs("</figure>\n<div>", out);
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
  fputs("<p class=\"note\">Friction is torque over the rotor's radius. Its line over dead "
        "weight has the friction coefficient for a slope; intercept over slope is the preload, "
        "and over π D L its mean pressure.</p>\n",
        out);
  fg_break_away_flag_words(a->flags, true, flags, sizeof flags);
  if (flags[0]) {
    fputs("<p><b>To know:</b> ", out);
    fg_html_text(out, flags);
    fputs(".</p>\n", out);
  }
  fputs("</div></div>\n", out);
}

/* Clearance over the azimuths, their table, their loops. */
static void put_directions(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  if (!b->directions) return;
  put_sentences(out, test, bearing);
  if (b->measured) {
    fputs("<figure>", out);
    fg_load_plot_azimuths(out, test, bearing);
    fprintf(out,
            "<figcaption>Clearance with U of its repeats alone; dashed the fitted harmonics, red "
            "where they are smallest%s.</figcaption></figure>\n",
            b->in_lot ? "; triangles the gap, orange the gap that the lot's foils leave a rotor"
                      : "");
  }
  put_load_table(out, test, bearing);
  fputs("<h2>Loops</h2>\n<p class=\"note\">Every cycle as recorded; the band is the threshold, "
        "orange where the loading strokes pass it. Beside it dF/dx of the loading strokes with U = "
        "2 u, orange its largest value up to just before the turn.</p>\n",
        out);
  put_loops(out, test, bearing);
}

static void put_bearing(FILE *out, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  fputs("<section>\n<header><h1>Bearing ", out);
  fg_html_text(out, b->name);
  fputs("</h1>", out);
  fg_html_verdict(out, fg_load_judge_bearing(test, bearing));
  if (b->directions)
    fprintf(out, "<p>%zu azimuth%s, threshold %g N</p></header>\n", b->directions,
            b->directions == 1 ? "" : "s", test->options.threshold_n);
  else
    fputs("<p>break-away test alone</p></header>\n", out);
  if (b->directions) put_load_tiles(out, test, bearing);
  put_break_away(out, test, bearing);
  put_directions(out, test, bearing);
  fputs("</section>\n", out);
}

static void put_end(FILE *out, const fg_load_test *test) {
  const fg_load_options *o = &test->options;
  fputs("<section>\n<h2 class=\"first\">Tests that were read</h2>\n<div class=\"scroll\"><table>\n"
        "<tr><th>file</th><th class=\"w\">not read</th><th class=\"w\">SHA-256</th></tr>\n",
        out);
  for (size_t i = 0; i < test->file_count; i++) {
    fputs("<tr><td class=\"path\">", out);
    fg_html_text(out, test->files[i].path);
    fputs("</td><td class=\"w\">", out);
    fg_html_text(out, test->files[i].not_read ? test->files[i].not_read : "");
    fprintf(out, "</td><td class=\"w\">%.12s…</td></tr>\n", test->files[i].sha256);
  }
  fprintf(out,
          "</table></div>\n<p class=\"note\">± is U = 2 u. Instruments, standard: load cell %g %%, "
          "displacement %g %%, together %.2f %% of a stiffness. Loss factor: loop area / (π K X²), "
          "X half of the travel, K the largest stiffness up to 1 %% of the travel (10 times the "
          "displacement's noise where that is more) before the turn, or that of the loop's ends "
          "(secant); a foil that hardens is stiffer beyond K's place; of the foil: energy lost in "
          "its compression / (2π × elastic work), whatever "
          "the gap is.</p>\n</section>\n",
          o->u_force_pct, o->u_displacement_pct, hypot(o->u_force_pct, o->u_displacement_pct));
}

/* Writes the limits, and the quantities without one. */
static void put_limits(FILE *out, const fg_load_test *test) {
  const fg_load_options *o = &test->options;
  bool comma = false;
  fputs("<dl class=\"facts\">\n<dt>Limits</dt><dd>", out);
  for (size_t i = 0; i < o->limit_count; i++) {
    const fg_tolerance *l = &o->limits[i];
    fprintf(out, "%s%s", i ? ", " : "", l->quantity);
    if (isfinite(l->lower)) fprintf(out, " from %g", l->lower);
    if (isfinite(l->upper)) fprintf(out, " to %g", l->upper);
  }
  fprintf(out, "%s</dd>\n<dt>Not judged</dt><dd>", o->limit_count ? "" : "none");
  for (int q = 0; q < FG_LOAD_QUANTITIES; q++) {
    const char *name = fg_load_quantity_name((fg_load_quantity)q);
    bool judged = false;
    for (size_t i = 0; i < o->limit_count; i++)
      judged = judged || !strcmp(o->limits[i].quantity, name);
    if (judged) continue;
    fprintf(out, "%s%s", comma ? ", " : "", name);
    comma = true;
  }
  fprintf(out, "%s</dd>\n</dl>\n", comma ? "" : "nothing");
}

static fg_status put_provenance(fg_context *ctx, FILE *out, const fg_load_test *test) {
  fg_provenance from = {.of_scans = false};
  for (size_t i = 0; i < test->file_count; i++)
    fg_provenance_include_file(&from, test->files[i].path);
  return fg_html_provenance_section(ctx, out, &from);
}

fg_status fg_load_write_html(fg_context *ctx, const fg_load_test *test, FILE *out) {
  char words[300];
  fg_report_outcome outcome;
  fg_load_judge(test, &outcome, words, sizeof words);
  fg_html_begin(out, "Load-displacement tests");
  fputs("<section>\n<header><h1>Load-displacement tests of bearings</h1>", out);
  fg_html_verdict(out, outcome.verdict);
  fputs("</header>\n<p class=\"say\">", out);
  fg_html_text(out, words);
  fputs(".</p>\n", out);
  put_limits(out, test);
  fputs("</section>\n", out);
  for (size_t i = 0; i < test->bearing_count; i++)
    put_bearing(out, test, i);
  put_end(out, test);
  FG_TRY(put_provenance(ctx, out, test));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
