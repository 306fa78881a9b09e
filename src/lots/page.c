/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page over lots: sentences and lots first, then figures and numbers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/words.h"
#include "lots/index.h"
#include "lots/members.h"
#include "page/page.h"
#include "page/table.h"
#include "page/verdict.h"
#include "report/lot/page_parts.h"
#include "report/provenance.h"

enum {
  LOTS_FIRST_MAX = 20,
  LOTS_SPREAD_MIN = 3, /* two lots are a pair, which says it all */
  VALUE = 96,
};

/* Returns a folder relative to the page's, both as given: the link of a lot beside or below the
 * page survives when all is moved together. */
static const char *strip_page_folder(const char *page, const char *folder) {
  const char *slash = strrchr(page, '/');
  size_t length = slash ? (size_t)(slash - page) + 1 : 0;
  return length && !strncmp(page, folder, length) ? folder + length : folder;
}

static void put_text_lines(FILE *out, const char *text) {
  fputs("<ul class=\"flags\">\n", out);
  while (text && *text) {
    char line[1200];
    size_t length = strcspn(text, "\n");
    snprintf(line, sizeof line, "%.*s", (int)length, text);
    fputs("<li>", out);
    fg_html_text(out, line);
    fputs("</li>\n", out);
    text += length + (text[length] == '\n');
  }
  fputs("</ul>\n", out);
}

void fg_index_put_lot_date(FILE *out, const fg_subject *subject) {
  const fg_lot_date *date = &((const fg_index_lot *)subject->object)->date;
  if (!date->from) {
    fputs("–<i>not known</i>", out);
    return;
  }
  fputs(date->first, out);
  if (strcmp(date->first, date->last) != 0) fprintf(out, " to<br>%s", date->last);
  if (!strcmp(date->from, FG_LOT_DATE_SCANS)) fputs("<i>of the scans&#39; files</i>", out);
}

void fg_index_put_lot_link(FILE *out, const fg_subject *subject) {
  const fg_index *index = subject->whole;
  const fg_index_lot *lot = subject->object;
  fputs("<a href=\"", out);
  fg_lot_put_href(out, strip_page_folder(index->page, lot->folder));
  fputs("/index.html\">", out);
  fg_html_text(out, lot->name);
  fputs("</a><i>", out);
  fg_html_text(out, lot->folder);
  fputs("</i>", out);
}

void fg_index_put_lot_verdict(FILE *out, const fg_subject *subject) {
  fg_html_verdict(out, ((const fg_index_lot *)subject->object)->verdict);
}

void fg_index_put_lot_design(FILE *out, const fg_subject *subject) {
  const fg_index *index = subject->whole;
  const fg_index_lot *lot = subject->object;
  fg_html_text(out, lot->design.name);
  if (index->designs > 1) fprintf(out, "<i>design %zu</i>", lot->design_number);
}

static void put_lot_table(FILE *out, const fg_index *index) {
  fg_html_table(out, &fg_index_lot_members, &(fg_subject){.object = index, .whole = index},
                fg_index_read_lot_at);
  fputs("<p class=\"note\">In order of date, by which every figure is ordered and "
        "numbered. A lot is as good as its worst foil.</p>\n",
        out);
}

/* Returns true when the table of the lots would push the figures out of sight. */
static bool has_many_lots(const fg_index *index) {
  return index->read > LOTS_FIRST_MAX;
}

static void put_index_first_screen(FILE *out, const fg_index *index) {
  fprintf(out,
          "<section class=\"part\">\n<header><h1>%zu lot%s, one after the other and against each "
          "other</h1>"
          "</header>\n<ul class=\"words\">\n",
          index->read, index->read == 1 ? "" : "s");
  for (size_t i = 0; i < index->sentence_count; i++) {
    fputs("<li>", out);
    fg_html_text(out, index->sentences[i]);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
  if (index->notes) put_text_lines(out, index->notes);
  if (has_many_lots(index))
    fputs("<p class=\"note\">Which lot has which number, its date, folder and verdict: <a "
          "href=\"#lots\">the lots</a>, behind the figures.</p>\n",
          out);
  else
    put_lot_table(out, index);
  fputs("</section>\n", out);
}

static bool has_curves(const fg_index *index) {
  for (size_t i = 0; i < index->read; i++)
    if (index->lots[i].spread.has_density) return true;
  return false;
}

static void put_spread_tables(FILE *out, const fg_index *index) {
  fg_html_table(out, &fg_index_lot_spread_members, &(fg_subject){.object = index, .whole = index},
                fg_index_lot_spread_at);
}

static void put_densities(FILE *out, const fg_index *index) {
  if (!has_curves(index)) return;
  fputs("<section class=\"part\">\n<h1>Bump radius over design</h1>\n<figure>", out);
  fg_index_plot_lots(out, index);
  fputs(
      "<figcaption>Kernel densities of R / R_D, each lot&#39;s radii over the radius of its own "
      "design: 1 is a bump as designed, above 1 it has sprung open. Numbers at the curves are the "
      "lots&#39;.</figcaption></figure>\n",
      out);
  if (!has_many_lots(index)) put_spread_tables(out, index);
  fputs("</section>\n", out);
}

/* Puts the tables of many lots behind the figures. */
static void put_tables_of_many(FILE *out, const fg_index *index) {
  if (!has_many_lots(index)) return;
  fputs("<section id=\"lots\" class=\"part\">\n<h1>The lots</h1>\n", out);
  put_lot_table(out, index);
  fputs("</section>\n<section class=\"part\">\n<h1>Bump radius over design, lot by lot</h1>\n",
        out);
  put_spread_tables(out, index);
  fputs("</section>\n", out);
}

/* Puts the scatter of the lots' means beyond that of their foils. */
static void put_axis_words(FILE *out, const fg_index_axis *axis) {
  char a[VALUE], b[VALUE], p[16];
  if (axis->lots < LOTS_SPREAD_MIN) return;
  fg_index_value(axis, axis->between.sd, a, sizeof a);
  fprintf(out, "From lot to lot s = %s", a);
  fg_index_value(axis, axis->between.sd_low, a, sizeof a);
  fg_index_value(axis, axis->between.sd_high, b, sizeof b);
  fprintf(out, " (95 %%: %s to %s)", a, b);
  fg_index_value(axis, axis->within_sd, a, sizeof a);
  fprintf(out, ", from foil to foil within lots %s", a);
  if (isfinite(axis->p_equal)) {
    fg_index_p(axis->p_equal, p, sizeof p);
    fprintf(out, "; all lots alike: p %s", *p == '<' ? "&lt; 0.0001" : p);
  }
  fputs(".", out);
}

static bool is_axis_shown(const fg_index *index, const fg_index_axis *axis) {
  if (axis->scale == FG_INDEX_APART) return false;
  return axis->same_as == FG_INDEX_NONE || (axis->limited && !index->axes[axis->same_as].limited);
}

static void put_axis_figures(FILE *out, const fg_index *index) {
  const char *separator = "<p class=\"note\">Not drawn, for they say of every foil what another "
                          "quantity says: ";
  fputs("<section class=\"part\">\n<h1>Every quantity over the lots</h1>\n<p "
        "class=\"note\">Circle: the lot&#39;s "
        "mean; bar: ± s of its single values. Red, dashed: tolerance. ",
        out);
  if (index->read < FG_INDEX_LOTS_MIN)
    fprintf(out, "Limits of the means over lots take %d lots; here are %zu.", FG_INDEX_LOTS_MIN,
            index->read);
  else
    fputs("Grey, between thin lines: where the other lots put the mean of this one (three sigma, "
          "by the scatter of the "
          "other lots&#39; means and of foils, with Student&#39;s t: few lots say little). Red "
          "square: a mean that lies outside.",
          out);
  fputs("</p>\n", out);
  for (size_t i = 0; i < index->axis_count; i++) {
    const fg_index_axis *axis = &index->axes[i];
    if (!is_axis_shown(index, axis)) continue;
    fprintf(out, "<figure><h2>%c%s%s</h2>\n",
            axis->row->words[0] >= 'a' && axis->row->words[0] <= 'z' ? axis->row->words[0] - 32
                                                                     : axis->row->words[0],
            axis->row->words + 1,
            axis->scale == FG_INDEX_OVER_DESIGN ? ", over each lot&#39;s design" : "");
    fg_index_plot_axis(out, index, axis);
    fputs("<figcaption>", out);
    put_axis_words(out, axis);
    fputs("</figcaption></figure>\n", out);
  }
  for (size_t i = 0; i < index->axis_count; i++) {
    const fg_index_axis *axis = &index->axes[i];
    if (axis->same_as == FG_INDEX_NONE || is_axis_shown(index, axis)) continue;
    fprintf(out, "%s%s (%s)", separator, axis->row->words, index->axes[axis->same_as].row->symbol);
    separator = "; ";
  }
  if (*separator == ';') fputs(".</p>\n", out);
  fputs("</section>\n", out);
}

static void put_mean_cell(FILE *out, const fg_index_axis *axis, const fg_index_stat *stat) {
  char mean[VALUE] = "–", sd[VALUE] = "";
  if (stat && stat->count) {
    fg_index_value(axis, stat->mean, mean, sizeof mean);
    fg_index_value(axis, stat->sd, sd, sizeof sd);
  }
  fprintf(out, "<td%s>%s<i>%s</i></td>", stat && stat->unexpected ? " class=\"fail\"" : "", mean,
          sd);
}

static void put_means_table(FILE *out, const fg_index *index) {
  fputs("<section class=\"part\">\n<h1>Mean and s of every quantity</h1>\n<div class=\"scroll "
        "lots\"><table><thead><tr>"
        "<th>no.</th><th class=\"w\">lot</th>",
        out);
  for (size_t i = 0; i < index->axis_count; i++)
    if (is_axis_shown(index, &index->axes[i]))
      fprintf(out, "<th>%s%s</th>", index->axes[i].row->symbol,
              index->axes[i].scale == FG_INDEX_OVER_DESIGN ? "<br>/ design" : "");
  fputs("</tr></thead>\n<tbody>\n", out);
  for (size_t i = 0; i < index->read; i++) {
    fprintf(out, "<tr><td>%zu</td><td class=\"words\">", i + 1);
    fg_html_text(out, index->lots[i].name);
    fputs("</td>", out);
    for (size_t k = 0; k < index->axis_count; k++)
      if (is_axis_shown(index, &index->axes[k]))
        put_mean_cell(out, &index->axes[k], fg_index_stat_of(&index->axes[k], &index->lots[i]));
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n<p class=\"note\">Mean, below it s of the single values. Red: a "
        "mean that the other lots do not make likely.</p>\n</section>\n",
        out);
}

static void put_unread(FILE *out, const fg_index *index) {
  if (index->read == index->count) return;
  fprintf(out, "<section class=\"part\">\n<h1>Not on this page: %zu</h1>\n<ul class=\"flags\">\n",
          index->count - index->read);
  for (size_t i = index->read; i < index->count; i++) {
    fputs("<li>", out);
    fg_html_text(out, index->lots[i].problem);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n</section>\n", out);
}

static fg_status put_index_provenance(fg_context *ctx, FILE *out, const fg_index *index) {
  fg_provenance from = {.design = index->read ? &index->lots[0].design : NULL};
  size_t stated = 0;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_lot *lot = &index->lots[i];
    fg_provenance_include_date(&from, lot->date.first);
    fg_provenance_include_date(&from, lot->date.last);
    stated += lot->design.calibration.stated;
    if (lot->design_number != index->lots[0].design_number) from.design = NULL;
  }
  from.design_words = "not the same in all lots: in the page of each";
  from.calibration_words = stated == 0 ? "none is stated in any lot: U holds statistics only"
                           : stated == index->read ? "in the page of each lot"
                                                   : "not stated in all lots: in the page of each";
  return fg_html_provenance_section(ctx, out, &from);
}

fg_status fg_index_write_page(fg_context *ctx, const fg_index *index, FILE *out) {
  fg_html_begin(out, "Lots");
  put_index_first_screen(out, index);
  put_unread(out, index);
  fg_index_put_predictions(out, index);
  put_densities(out, index);
  put_axis_figures(out, index);
  fg_index_put_pairs(out, index);
  fg_index_put_dies(out, index);
  put_tables_of_many(out, index);
  put_means_table(out, index);
  FG_TRY(put_index_provenance(ctx, out, index));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page over lots");
}
