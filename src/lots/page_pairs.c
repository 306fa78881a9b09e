/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page over lots: pairs of lots and of dies that differ. */
#include <math.h>
#include <stdlib.h>

#include "core/text.h"
#include "lots/index.h"
#include "lots/members.h"
#include "page/page.h"
#include "page/table.h"

enum {
  PAIRS_SHOWN_MAX = 40,
  PAIRS_ALIKE = 5, /* nearest pairs among those that do not differ */
};

static size_t count_shown_pairs(const fg_index *index) {
  size_t max = index->differing + PAIRS_ALIKE;
  if (max > PAIRS_SHOWN_MAX) max = PAIRS_SHOWN_MAX;
  return max < index->pair_count ? max : index->pair_count;
}

static bool find_shown_pair(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->pairs[i];
  return i < count_shown_pairs(index);
}

static bool find_shown_die_pair(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->die_pairs[i];
  return i < index->die_pair_count && i < PAIRS_SHOWN_MAX;
}

static void put_index_table(FILE *out, const fg_index *index, const fg_members *members,
                            fg_member_element *element) {
  fg_html_table(out, members, &(fg_subject){.object = index, .whole = index}, element);
}

void fg_index_put_pairs(FILE *out, const fg_index *index) {
  size_t pairs = index->pair_count, shown = count_shown_pairs(index);
  if (!shown) return;
  fputs("<section class=\"part\">\n<h1>Which lots differ</h1>\n", out);
  put_index_table(out, index, &fg_index_pair_members, find_shown_pair);
  fprintf(
      out,
      "<p class=\"note\">Bold: differs beyond chance, %zu of %zu tests%s. "
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

void fg_index_put_dies(FILE *out, const fg_index *index) {
  if (index->die_count < 2) return;
  fputs("<section class=\"part\">\n<h1>Dies</h1>\n<figure>", out);
  fg_index_plot_dies(out, index);
  fputs("<figcaption>Kernel densities of R / R_D of all foils of a die, whatever their lot."
        "</figcaption></figure>\n",
        out);
  put_index_table(out, index, &fg_index_die_spread_members, fg_index_die_spread_at);
  fputs("<h2>Which dies differ</h2>\n", out);
  if (index->die_pair_count)
    put_index_table(out, index, &fg_index_die_pair_members, find_shown_die_pair);
  fputs(
      "<p class=\"note\">Dies are held against each other within lots that have foils of both, so "
      "that a lot&#39;s own difference falls out; else lot mean against lot mean. Where each die "
      "stands in one lot only, a difference of dies cannot be told from one of lots."
      "</p>\n</section>\n",
      out);
}
