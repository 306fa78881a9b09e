/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page of a next die: what to cut and what comes of it first. */
#include <math.h>

#include "compensation/members.h"
#include "compensation/plots.h"
#include "core/file.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/provenance.h"

static double mean_of_radii(const fg_die_dimensions *die) {
  double sum = 0;
  for (size_t i = 0; i < die->bumps; i++)
    sum += die->bump[i].radius_mm / (double)die->bumps;
  return die->bumps ? sum : NAN;
}

static void put_next_tiles(FILE *out, const fg_next_die *next) {
  const fg_expected_lot *expected = &next->expected;
  const fg_die_dimensions *die = &next->die;
  bool bumps = die->bumps > 0;
  double u = bumps ? die->bump[0].u_radius_mm : 0;
  const fg_tile tiles[] = {
      {bumps ? "Bump radius of the die, mean" : NULL, .value = mean_of_radii(die), .u = u,
       .unit = "mm", .decimals = 4, .u_words = FG_TILE_U_IS_2U},
      {"Overall radius of the die", .value = die->overall_radius_mm, .u = die->u_overall_radius_mm,
       .unit = "mm", .decimals = 4, .u_words = FG_TILE_U_IS_2U},
      {"Expected overall radius", .value = expected->overall_radius_mm.value,
       .u = expected->overall_radius_mm.u, .unit = "mm", .decimals = 4, .u_words = FG_TILE_U_IS_2U},
      {expected->tolerances ? "Foils expected in tolerance" : NULL, .value = 100 * expected->share,
       .decimals = 1, .unit = "%"},
      {isfinite(expected->assembled) ? "Bearings that a rotor fits into" : NULL,
       .value = 100 * expected->assembled, .decimals = 1, .unit = "%"},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_next_notes(FILE *out, const fg_next_die *next) {
  if (!next->notes) return;
  fputs("<ul class=\"flags\">\n", out);
  for (size_t i = 0; i < next->notes; i++) {
    fputs("<li>", out);
    fg_html_text(out, next->note[i]);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
}

static void put_first_screen(FILE *out, const fg_next_die *next) {
  char sentence[FG_MEMBER_TEXT_MAX];
  fg_next_die_sentence(next, sentence, sizeof sentence);
  fputs("<section class=\"part\">\n<header><h1>Next die for ", out);
  fg_html_text(out, next->target.name);
  fputs("</h1></header>\n<ul class=\"words\"><li>", out);
  fg_html_text(out, sentence);
  fputs("</li></ul>\n", out);
  put_next_tiles(out, next);
  put_next_notes(out, next);
  fputs("</section>\n", out);
}

static void put_bumps(FILE *out, const fg_next_die *next, const fg_subject *list) {
  if (!next->die.bumps) return;
  fputs("<section class=\"part\">\n<h1>Every bump</h1>\n<figure>", out);
  fg_next_die_plot_radii(next, out);
  fputs("<figcaption>Line: the target. Bars: U of the next die by the law of the springback, and "
        "the 95 % interval of the mean of the next lot&#39;s foils, which holds also what lots "
        "differ by.</figcaption></figure>\n",
        out);
  fg_html_table(out, &fg_next_bump_members, list, fg_next_bump_at);
  fputs("</section>\n", out);
}

static void put_expected_shares(FILE *out, const fg_next_die *next, const fg_subject *list) {
  if (!next->expected.tolerances) return;
  fputs("<section class=\"part\">\n<h1>Foils within the target&#39;s tolerances</h1>\n", out);
  fg_html_table(out, &fg_expected_share_members, list, fg_expected_share_at);
  fputs("<p class=\"note\">Drawn from the posterior of the law, with the deviations of the foils "
        "that were measured. A foil is within with all of its bumps. From, to: 95 % of lots of "
        "that size.</p>\n</section>\n",
        out);
}

static void put_trade(FILE *out, const fg_next_die *next, const fg_subject *list) {
  char sentence[600];
  if (!next->settings) return;
  fg_setting_sentence(next, sentence, sizeof sentence);
  fputs("<section class=\"part\">\n<h1>Die and heat treatment together</h1>\n<ul "
        "class=\"words\"><li>",
        out);
  fg_html_text(out, sentence);
  fputs("</li></ul>\n<figure>", out);
  fg_next_die_plot_settings(next, out);
  fputs("<figcaption>Square: the lots&#39; setting; diamond: the setting of the smallest u. A bake "
        "that springs back less needs a smaller step of the die, but rests on the experiment; half "
        "of the change is in u, for bumps need not follow its response. A gap: the experiment does "
        "not tell the springback there from none.</figcaption></figure>\n",
        out);
  fg_html_table(out, &fg_setting_trade_members, list, fg_setting_trade_at);
  fputs("<p class=\"note\">The die above is of the lots&#39; setting. A lot of another setting "
        "begins a law of its own.</p>\n</section>\n",
        out);
}

static void put_law(FILE *out, const fg_subject *list) {
  fputs("<section class=\"part\">\n<h1>What the lots show of the springback</h1>\n", out);
  fg_html_table(out, &fg_formed_law_members, list, fg_formed_law_at);
  fg_html_table(out, &fg_formed_set_members, list, fg_formed_set_at);
  fputs(
      "<p class=\"note\">Springback is 100 ln(formed / die). Exponent: 0 where the ratio does not "
      "depend on the die&#39;s own size; equal to the springback where the lost curvature does "
      "not.</p>\n</section>\n",
      out);
}

fg_status fg_next_die_write_html(fg_context *ctx, const fg_next_die *next, FILE *out) {
  const fg_subject list = {.object = next, .whole = next};
  fg_provenance from = {.design = &next->target};
  for (size_t i = 0; i < next->law->sets; i++)
    fg_provenance_include_date(&from, next->law->set[i].date);
  fg_html_begin(out, "Next die");
  put_first_screen(out, next);
  fputs("<section class=\"part\">\n<h1>Die and expected foil</h1>\n<figure>", out);
  FG_TRY(fg_next_die_plot_profile(ctx, next, out));
  fputs(
      "<figcaption>Datum lines, true to scale, with their middle lands on each other.</figcaption>"
      "</figure>\n</section>\n",
      out);
  put_bumps(out, next, &list);
  put_expected_shares(out, next, &list);
  put_trade(out, next, &list);
  put_law(out, &list);
  FG_TRY(fg_html_provenance_section(ctx, out, &from));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page of the next die");
}
