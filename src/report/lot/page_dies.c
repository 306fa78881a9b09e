/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: share of the deviation that the dies explain. */
#include <math.h>

#include "core/text.h"
#include "lot/statistics/dies.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "page/table.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"

enum { NUMBERS_MAX = FG_LOT_DIE_BUMPS_MAX };

/* Mean errors by bump number of one die's foils, and of the die. */
typedef struct curve {
  double number[NUMBERS_MAX], foils[NUMBERS_MAX], die[NUMBERS_MAX];
  size_t count;
} curve;

static void find_die_curve(const fg_lot_analysis *analysis, const fg_lot_die *die, curve *out) {
  double design_mm = analysis->lot->settings.design.bumps.radius_mm;
  out->count = 0;
  for (int number = 1; number <= NUMBERS_MAX; number++) {
    double sum = 0, n = 0, own = NAN;
    for (size_t i = 0; i < analysis->foil_count; i++) {
      const fg_lot_foil *foil = &analysis->foils[i];
      for (size_t k = 0; k < foil->foil->bump_count; k++) {
        const fg_bump *bump = &foil->foil->bumps[k];
        if (bump->number != number || !fg_lot_bump_counts(foil->foil, bump)) continue;
        fg_lot_to_die to = fg_lot_bump_to_die(analysis->lot, foil, bump);
        if (to.die != die || !isfinite(bump->radius_error_pct)) continue;
        sum += bump->radius_error_pct;
        n++;
        own = 100 * (to.radius_mm - design_mm) / design_mm;
      }
    }
    if (n == 0) continue;
    out->number[out->count] = number;
    out->foils[out->count] = sum / n;
    out->die[out->count++] = own;
  }
}

/* Puts the mean error of a die's foils, and the die's own. */
static void put_die_plot(FILE *out, const fg_lot_analysis *analysis, const fg_lot_die *die,
                         const double range[2]) {
  curve c;
  char text[200];
  find_die_curve(analysis, die, &c);
  if (!c.count) return;
  fg_plot plot = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Radius error of the foils and of their die, by bump number",
                            .width = 520, .height = 270, .left = 66, .right = 10, .top = 34,
                            .x = (double[]){c.number[0] - 0.6, c.number[c.count - 1] + 0.6},
                            .y = range, .y_title = "against design, %", .ticks = FG_TICKS_OWN});
  for (size_t i = 0; i < c.count; i++) {
    fg_plot_x_number(&plot, (int)c.number[i]);
    fg_plot_segment(&plot, c.number[i], c.die[i], c.number[i], c.foils[i], "hint");
  }
  fg_plot_x_title(&plot, "bump");
  fg_plot_line(&plot, c.number, c.die, c.count, "s2");
  fg_plot_line(&plot, c.number, c.foils, c.count, "s1");
  for (size_t i = 0; i < c.count; i++) {
    fg_plot_dot(&plot, c.number[i], c.die[i], 5, "s2");
    fg_plot_dot(&plot, c.number[i], c.foils[i], 5, "s1");
  }
  fg_text_clip(text, sizeof text, "foils of die %s", die->name);
  fg_plot_key(&plot, 80, "s1", text);
  fg_text_clip(text, sizeof text, "die %s", die->name);
  fg_plot_key(&plot, 300, "s2", text);
  fg_plot_end(&plot);
}

static void find_error_range(const fg_lot_analysis *analysis, const fg_lot_dies *dies,
                             double range[2]) {
  range[0] = range[1] = 0;
  for (size_t d = 0; d < dies->count; d++) {
    curve c;
    find_die_curve(analysis, dies->sum[d].die, &c);
    for (size_t i = 0; i < c.count; i++) {
      fg_range_add(range, c.die[i], 0);
      fg_range_add(range, c.foils[i], 0);
    }
  }
  fg_range_pad(range, 0.1, 0.05);
}

static void put_die_sentences(FILE *out, const fg_lot_dies *dies) {
  fputs("<ul class=\"words\">\n", out);
  for (size_t i = 0; i < dies->count; i++) {
    const fg_lot_die_sum *sum = &dies->sum[i];
    fputs("<li>Die ", out);
    fg_html_name(out, sum->die->name);
    fprintf(
        out,
        ": its foils' radii are off the design's by %+.2f %%, of which the die itself has %+.3f ± "
        "%.3f %%; springback is what is left, %+.2f %% of the die.",
        sum->design_mean_pct, sum->die_error_pct, FG_COVERAGE_FACTOR * sum->u_die_error_pct,
        sum->die_mean_pct);
    if (sum->by_mean)
      fprintf(out, " Held against the die's mean, as no trace shows theirs: %zu of %zu bumps.",
              sum->by_mean, sum->bumps);
    fputs("</li>\n", out);
  }
  if (dies->count == 2) {
    fputs("<li>The radii of the foils of die ", out);
    fg_html_name(out, dies->sum[1].die->name);
    fputs(" and of die ", out);
    fg_html_name(out, dies->sum[0].die->name);
    fprintf(out, " differ by %+.3f %%; the dies differ by %+.3f %%, which is %.0f %% of it.</li>\n",
            dies->foils_differ_pct, dies->dies_differ_pct, dies->explained_difference_pct);
  }
  if (isfinite(dies->explained_variance_pct)) {
    fprintf(out,
            "<li>Over all %zu bumps the standard deviation is %.3f %% against the design and %.3f "
            "%% against the dies: ",
            dies->all.bumps, dies->all.design_sd_pct, dies->all.die_sd_pct);
    if (dies->explained_variance_pct > 0)
      fprintf(out, "the dies explain %.0f %% of the variance.</li>\n",
              dies->explained_variance_pct);
    else
      fputs("the dies explain none of the scatter.</li>\n", out);
  }
  fputs("</ul>\n", out);
}

/* Elements of the table: every die, then all of them. */
static bool find_die_line(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_dies *dies = list->object;
  element->object = i < dies->count ? &dies->sum[i] : &dies->all;
  return i <= dies->count;
}

void fg_lot_put_dies(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_dies *dies = &analysis->dies;
  double range[2];
  if (!dies->count) return;
  find_error_range(analysis, dies, range);
  fputs("<section class=\"part\">\n<h1>Dies: what of the deviation is theirs</h1>\n", out);
  put_die_sentences(out, dies);
  fputs("<div class=\"pair\">", out);
  for (size_t i = 0; i < dies->count; i++) {
    fputs("<figure>", out);
    put_die_plot(out, analysis, dies->sum[i].die, range);
    fputs("</figure>\n", out);
  }
  fputs(
      "</div>\n<p class=\"note\">Orange: mean radius error of the foils against the design; blue: "
      "the die&#39;s, as <code>foilgauge die</code> measured it (mean of its halves); the dashed "
      "way between them is springback.</p>\n",
      out);
  fg_html_table(out, &fg_lot_die_sum_members, &(fg_subject){.object = dies, .whole = analysis},
                find_die_line);
  fputs("<p class=\"note\">Bump by bump: radius_error_to_die_pct in bumps.csv. What all dies err "
        "by alike is no part of the scatter.</p>\n</section>\n",
        out);
}
