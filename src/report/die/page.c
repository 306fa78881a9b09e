/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die's page: outcome, errors by half, then each half with its traces. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/die_report.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "page/verdict.h"
#include "report/die/members.h"
#include "report/die/plots.h"
#include "report/provenance.h"

static const char *const datum_words[] = {"midline", "inner side", "outer side"};
static const char *const half_words[FG_DIE_HALVES] = {
    "Concave half: grooves, touches the strip's inner side",
    "Convex half: ridges, touches the strip's outer side"};

static fg_tile make_error_tile(const char *title, const fg_die_value *v) {
  return (fg_tile){title,        .value = v->value,         .u = v->u, .unit = "%", .decimals = 3,
                   .plus = true, .u_words = FG_TILE_U_IS_2U};
}

/* Largest sd of one repeat over the bumps of both halves. */
static double largest_sd(const fg_die *die) {
  double max = NAN;
  for (int half = 0; half < FG_DIE_HALVES; half++)
    for (size_t i = 0; i < die->half[half].bump_count; i++)
      max = fmax(max, die->half[half].bumps[i].value[FG_DIE_RADIUS].sd);
  return max;
}

static void put_die_tiles(FILE *out, const fg_die *die) {
  const fg_die_side *a = &die->half[FG_DIE_CONCAVE], *b = &die->half[FG_DIE_CONVEX];
  const fg_die_side *whole = &die->whole;
  const fg_tile tiles[] = {
      make_error_tile(a->traces ? "Radius error, concave, mean" : NULL,
                      &a->mean[FG_DIE_RADIUS_ERROR]),
      make_error_tile(b->traces ? "Radius error, convex, mean" : NULL,
                      &b->mean[FG_DIE_RADIUS_ERROR]),
      make_error_tile(a->traces && b->traces ? "Radius error of the die" : NULL,
                      &whole->mean[FG_DIE_RADIUS_ERROR]),
      make_error_tile("Bump angle error, mean", &whole->mean[FG_DIE_ANGLE_ERROR]),
      make_error_tile("Overall radius error", &whole->overall_error_pct),
      {"Repeats of R, largest s", .value = 1000 * largest_sd(die), .decimals = 2, .unit = "µm",
       .unknown = "one trace of each half"},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

/* Writes the result of each half in a sentence. */
static void put_sentences(FILE *out, const fg_die *die) {
  char unseen[200];
  fputs("<ul class=\"words\">\n", out);
  for (int half = 0; half < FG_DIE_HALVES; half++) {
    const fg_die_side *side = &die->half[half];
    if (!side->traces) {
      fprintf(out, "<li>No trace of the %s half: the die's values are the other half's.</li>\n",
              fg_die_half_word((fg_die_half)half));
      continue;
    }
    const fg_die_value *radius = &side->mean[FG_DIE_RADIUS];
    const fg_die_value *error = &side->mean[FG_DIE_RADIUS_ERROR];
    bool sure = fabs(error->value) > FG_COVERAGE_FACTOR * error->u;
    fprintf(out,
            "<li>The %s half's bumps have a radius of %.5f ± %.5f mm: %+.3f ± %.3f %% of the "
            "design's %.4f mm%s.",
            fg_die_half_word((fg_die_half)half), radius->value, FG_COVERAGE_FACTOR * radius->u,
            error->value, FG_COVERAGE_FACTOR * error->u, die->design.bumps.radius_mm,
            sure ? "" : ", which is within U");
    if (fg_die_unseen(die, (fg_die_half)half, FG_DIE_UNTRACED, unseen, sizeof unseen))
      fprintf(out, " No trace shows bump %s whole.", unseen);
    if (fg_die_unseen(die, (fg_die_half)half, FG_DIE_LOST, unseen, sizeof unseen))
      fprintf(out, " Lost to dust or a lost contact: bump %s.", unseen);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
}

static void put_die_value(FILE *out, const fg_die *die, const fg_die_value *v, fg_die_quantity q) {
  const fg_die_row *row = fg_die_row_of(q);
  int decimals = row->decimals;
  double expanded = FG_COVERAGE_FACTOR * v->u;
  /* U shows two digits, or one where that is fine enough. */
  while (decimals < 6 && expanded > 0 && expanded * pow(10, decimals) < 3)
    decimals++;
  fprintf(out, "<td class=\"%s\">%.*f<i>± %.*f</i></td>",
          fg_verdict_word(fg_die_judge_value(die, row->name, v)), decimals,
          fabs(v->value) * pow(10, decimals) < 0.5 ? 0 : v->value, decimals, expanded);
}

static const fg_die_quantity columns[] = {FG_DIE_RADIUS,      FG_DIE_RADIUS_ERROR, FG_DIE_ANGLE,
                                          FG_DIE_ANGLE_ERROR, FG_DIE_HEIGHT,       FG_DIE_CENTRE,
                                          FG_DIE_PLACE};
enum { COLUMNS = sizeof columns / sizeof *columns };

static void put_die_head(FILE *out, const fg_die *die, const char *count, const char *sd) {
  fputs("<div class=\"scroll\"><table>\n<tr><th>bump</th>", out);
  for (size_t i = 0; i < COLUMNS; i++) {
    const fg_die_row *row = fg_die_row_of(columns[i]);
    fprintf(out, "<th title=\"%s\">%s, %s</th>", row->words, row->symbol, row->unit);
    if (columns[i] == FG_DIE_RADIUS) fprintf(out, "<th>%s, µm</th>", sd);
  }
  fprintf(out, "<th>%s</th></tr>\n<tr class=\"limits\"><td>design</td>", count);
  for (size_t i = 0; i < COLUMNS; i++) {
    fprintf(out, "<td>%.*f</td>", fg_die_row_of(columns[i])->decimals,
            fg_die_nominal(&die->design, &die->nominal, columns[i]));
    if (columns[i] == FG_DIE_RADIUS) fputs("<td></td>", out);
  }
  fputs("<td></td></tr>\n", out);
}

/* `of`: owner of s; NULL: the column's heading names it. */
static void put_die_row(FILE *out, const fg_die *die, const fg_die_value v[FG_DIE_QUANTITIES],
                        const char *of) {
  for (size_t i = 0; i < COLUMNS; i++) {
    put_die_value(out, die, &v[columns[i]], columns[i]);
    if (columns[i] != FG_DIE_RADIUS) continue;
    if (isfinite(v[FG_DIE_RADIUS].sd))
      fprintf(out, "<td>%.2f", 1000 * v[FG_DIE_RADIUS].sd);
    else
      fputs("<td>–", out);
    if (of) fprintf(out, "<i>%s</i>", of);
    fputs("</td>", out);
  }
}

static void put_die_table(FILE *out, const fg_die *die, const fg_die_side *side, const char *count,
                          const char *sd) {
  fg_die no_limits = *die;
  no_limits.design.tolerance_count = 0; /* limits are of single bumps of a half */
  const fg_die *judge = side == &die->whole ? &no_limits : die;
  put_die_head(out, die, count, sd);
  for (size_t i = 0; i < side->bump_count; i++) {
    fprintf(out, "<tr><td>%d</td>", side->bumps[i].number);
    put_die_row(out, judge, side->bumps[i].value, NULL);
    fprintf(out, "<td>%zu</td></tr>\n", side->bumps[i].count);
  }
  fputs("<tr class=\"total on\"><td>mean</td>", out);
  put_die_row(out, &no_limits, side->mean, side == &die->whole ? NULL : "of the bumps");
  fputs("<td></td></tr>\n</table></div>\n", out);
  fprintf(
      out,
      "<p class=\"note\">Lands: R0 = %.4f ± %.4f mm, %+.3f %% of the design. ± is U = 2 u.</p>\n",
      side->overall_radius_mm.value, FG_COVERAGE_FACTOR * side->overall_radius_mm.u,
      side->overall_error_pct.value);
}

static void put_half(FILE *out, const fg_die *die, fg_die_half half) {
  fprintf(out, "<section>\n<h2 class=\"first\">%s</h2>\n", half_words[half]);
  fputs("<figure>", out);
  fg_die_plot_trace(out, die, half);
  fputs("<figcaption>The first trace, as the tip went, to scale; orange the bumps' circles, dashed "
        "the lands'.</figcaption></figure>\n<figure>",
        out);
  fg_die_plot_residuals(out, die, half);
  fputs("<figcaption>Residuals along the normal, outwards of each circle, a line per trace; means "
        "over 1/450 of the width. What all traces share is the die's form, what differs is the "
        "instrument.</figcaption></figure>\n",
        out);
  put_die_table(out, die, &die->half[half], "repeats", "s of repeats");
  fputs("</section>\n", out);
}

static fg_status put_traces(fg_context *ctx, FILE *out, const fg_die *die) {
  fputs("<h2>Where it comes from</h2>\n", out);
  fg_html_table(out, &fg_die_trace_members, &(fg_subject){.object = die, .whole = die},
                fg_die_trace_at);
  fprintf(out,
          "<p class=\"note\">The circles are fitted to the line of the tip's "
          "centre; the tip's radius (u %.3g µm) and the way to the strip's %s are taken off each "
          "radius. Scale: u %.3g ppm. Flanks steeper than %g° take no part.</p>\n",
          die->options.u_tip_um, datum_words[die->design.datum], die->options.u_scale_ppm,
          die->options.max_slope_deg);
  fg_provenance from = {.design = &die->design};
  for (size_t i = 0; i < die->trace_count; i++)
    fg_provenance_include_file(&from, die->traces[i].path);
  fputs("<dl class=\"facts\">\n", out);
  FG_TRY(fg_html_provenance(ctx, out, &from));
  fputs("</dl>\n", out);
  return FG_OK;
}

static void put_summary(FILE *out, const fg_die *die, const char *words,
                        const fg_report_outcome *outcome) {
  fputs("<section>\n<header><h1>Die against design ", out);
  fg_html_text(out, die->design.name);
  fputs("</h1>", out);
  fg_html_verdict(out, outcome->verdict);
  fprintf(out, "<p>%zu trace%s; radii of the strip's %s</p></header>\n<p class=\"say\">",
          die->trace_count, die->trace_count == 1 ? "" : "s", datum_words[die->design.datum]);
  fg_html_text(out, words);
  fputs(".</p>\n", out);
  put_die_tiles(out, die);
  put_sentences(out, die);
  fputs("<figure>", out);
  fg_die_plot_errors(out, die, FG_DIE_RADIUS_ERROR);
  fputs("<figcaption>Radius error of every bump against the design with U = 2 u; the thin lines "
        "are the halves' means, dashed red a limit.</figcaption></figure>\n<figure>",
        out);
  fg_die_plot_errors(out, die, FG_DIE_ANGLE_ERROR);
  fputs("<figcaption>The same of the bump angle.</figcaption></figure>\n</section>\n", out);
}

fg_status fg_die_write_html(fg_context *ctx, const fg_die *die, FILE *out) {
  char words[200], title[120];
  fg_report_outcome outcome;
  fg_die_judge(die, &outcome, words, sizeof words);
  words[0] = (char)(words[0] >= 'a' && words[0] <= 'z' ? words[0] - 32 : words[0]);
  snprintf(title, sizeof title, "Die against %s", die->design.name);
  fg_html_begin(out, title);
  put_summary(out, die, words, &outcome);
  for (int half = 0; half < FG_DIE_HALVES; half++)
    if (die->half[half].traces) put_half(out, die, (fg_die_half)half);
  fputs("<section>\n", out);
  if (die->half[0].traces && die->half[1].traces) {
    fputs("<h2 class=\"first\">The die: mean of both halves</h2>\n<p class=\"note\">A strip of "
          "constant thickness that is pressed between both has its midline half way between their "
          "surfaces. These values are a lot's reference of springback (recipe: dies).</p>\n",
          out);
    put_die_table(out, die, &die->whole, "halves", "s of the two");
  }
  FG_TRY(put_traces(ctx, out, die));
  fputs("</section>\n", out);
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
