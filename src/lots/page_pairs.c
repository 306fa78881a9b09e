/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page over lots: pairs of lots and of dies that differ. */
#include <math.h>
#include <stdlib.h>

#include "core/text.h"
#include "lots/index.h"
#include "page/page.h"

enum {
  PAIRS_SHOWN_MAX = 40,
  PAIRS_ALIKE = 5, /* nearest pairs among those that do not differ */
  VALUE = 96,
};

static void put_axis_value(FILE *out, double value, const char *format) {
  if (isfinite(value))
    fprintf(out, format, value);
  else
    fputs("–", out);
}

void fg_index_put_spread(FILE *out, const fg_index_spread *spread) {
  fprintf(out, "<td>%zu</td><td>", spread->count);
  put_axis_value(out, spread->mean, "%.4f");
  fputs("</td><td>", out);
  put_axis_value(out, spread->mode, "%.4f");
  fputs("</td><td>", out);
  put_axis_value(out, spread->relative_sd_pct, "%.2f %%");
  fputs("</td><td>", out);
  put_axis_value(out, spread->min, "%.3f to ");
  put_axis_value(out, spread->max, "%.3f");
  fputs("</td></tr>\n", out);
}

const char fg_index_spread_heads[] =
    "<th>bumps</th><th>mean</th><th>mode</th><th>relative s</th><th>range</th></tr></thead>\n"
    "<tbody>\n";

static void put_lot_pair(FILE *out, const fg_index *index, const fg_index_pair *pair, const char *a,
                         const char *b, const char *more) {
  const fg_index_axis *axis = &index->axes[pair->axis];
  char difference[VALUE], p[16];
  fg_index_difference(axis, pair, difference, sizeof difference);
  fg_index_p(pair->p_holm, p, sizeof p);
  fprintf(out, "<tr%s><td class=\"words\">%s%s</td><td class=\"words\">",
          pair->p_holm < 1 - FG_INDEX_CONFIDENCE ? " class=\"on\"" : "", axis->row->words,
          axis->scale == FG_INDEX_OVER_DESIGN ? ", over design" : "");
  fg_html_text(out, a);
  fputs("</td><td class=\"words\">", out);
  fg_html_text(out, b);
  fprintf(out, "</td><td>%s</td><td>%zu, %zu</td><td>%.1f</td><td>", difference, pair->foils_a,
          pair->foils_b, pair->dof);
  fg_html_text(out, p);
  fprintf(out, "</td>%s</tr>\n", more);
}

void fg_index_put_pairs(FILE *out, const fg_index *index) {
  size_t max = index->differing + PAIRS_ALIKE, pairs = index->pair_count;
  size_t shown = max < PAIRS_SHOWN_MAX ? max : PAIRS_SHOWN_MAX;
  char name[2][VALUE];
  shown = shown < pairs ? shown : pairs;
  if (!shown) return;
  fputs("<section class=\"part\">\n<h1>Which lots differ</h1>\n<div class=\"scroll "
        "lots\"><table><thead><tr><th>quantity"
        "</th><th class=\"w\">larger in lot</th><th class=\"w\">than in</th><th>by (95 %)</th><th>"
        "foils</th><th>degrees of<br>freedom</th><th>p, Holm</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < shown; i++) {
    const fg_index_pair *pair = &index->pairs[i];
    const size_t lots[2] = {pair->a, pair->b};
    for (int k = 0; k < 2; k++)
      fg_text_clip(name[k], VALUE, "%zu  %s", lots[k] + 1, index->lots[lots[k]].name);
    put_lot_pair(out, index, pair, name[0], name[1], "");
  }
  fprintf(
      out,
      "</tbody></table></div>\n<p class=\"note\">Bold: differs beyond chance, %zu of %zu tests%s. "
      "Welch&#39;s test of the means of foils: the error is what foils of one lot scatter, not "
      "bumps or beams, which one foil makes alike. All tests of lots are one family (Holm 1979): "
      "the "
      "chance of even one false difference among them is 5 %% at most. Intervals are of each "
      "pair by itself; what all scans of a scanner have in common is in none.</p>\n"
      "</section>\n",
      index->differing, pairs,
      shown < pairs ? "; those that are surest to differ are shown, the others are in the JSON "
                      "report"
                    : "");
}

static void put_die_pairs(FILE *out, const fg_index *index) {
  size_t shown = index->die_pair_count < PAIRS_SHOWN_MAX ? index->die_pair_count : PAIRS_SHOWN_MAX;
  char more[120], words[80];
  if (!shown) return;
  fputs("<div class=\"scroll lots\"><table><thead><tr><th>quantity</th><th class=\"w\">larger of "
        "die</th>"
        "<th class=\"w\">than of</th><th>by (95 %)</th><th>foils</th><th>degrees of<br>freedom</th>"
        "<th>p, Holm</th><th class=\"w\">by what</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < shown; i++) {
    const fg_index_die_pair *of = &index->die_pairs[i];
    if (of->basis == FG_INDEX_CONFOUNDED)
      fg_text_clip(words, sizeof words, "not separable from the lots");
    else
      fg_text_clip(words, sizeof words, "%s %zu lot%s",
                   of->basis == FG_INDEX_WITHIN_LOTS ? "within" : "between means of", of->lots,
                   of->lots == 1 ? "" : "s");
    fg_text_clip(more, sizeof more, "<td class=\"words\">%s</td>", words);
    put_lot_pair(out, index, &of->pair, index->dies[of->pair.a].name, index->dies[of->pair.b].name,
                 more);
  }
  fputs("</tbody></table></div>\n", out);
}

void fg_index_put_dies(FILE *out, const fg_index *index) {
  if (index->die_count < 2) return;
  fputs("<section class=\"part\">\n<h1>Dies</h1>\n<figure>", out);
  fg_index_plot_dies(out, index);
  fputs("<figcaption>Kernel densities of R / R_D of all foils of a die, whatever their lot."
        "</figcaption></figure>\n<div class=\"scroll "
        "lots\"><table><thead><tr><th>die</th><th>lots</th>"
        "<th>foils</th>",
        out);
  fputs(fg_index_spread_heads, out);
  for (size_t i = 0; i < index->die_count; i++) {
    fputs("<tr><td>", out);
    fg_html_text(out, index->dies[i].name);
    fprintf(out, "</td><td>%zu</td><td>%zu</td>", index->dies[i].lots, index->dies[i].foils);
    fg_index_put_spread(out, &index->dies[i].spread);
  }
  fputs("</tbody></table></div>\n<h2>Which dies differ</h2>\n", out);
  put_die_pairs(out, index);
  fputs(
      "<p class=\"note\">Dies are held against each other within lots that have foils of both, so "
      "that a lot&#39;s own difference falls out; else lot mean against lot mean. Where each die "
      "stands in one lot only, a difference of dies cannot be told from one of lots."
      "</p>\n</section>\n",
      out);
}
