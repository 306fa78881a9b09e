/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: tables of foils, the worst three and the list of all. */
#include <math.h>
#include <string.h>

#include "foilgauge/foil_kind.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"

/* The table; the index of its list. */
enum { WORST_FOILS, LISTED_FOILS };

static const fg_lot_analysis *lot_of(const fg_subject *subject) {
  return subject->whole;
}

/* Puts the first damaged beam with its defect; returns false where there is none. */
static bool put_damage(FILE *out, const fg_foil *foil) {
  for (size_t i = 0; i < foil->beam_count; i++) {
    const fg_foil_part part = fg_part_at(foil, FG_QUANTITY_OF_BEAM, i);
    if (fg_lot_part_counts(foil, FG_QUANTITY_OF_BEAM, &part)) continue;
    for (const fg_flag_words *words = fg_beam_flag_words(); words->name; words++) {
      if (!(part.flags & words->flag & FG_LOT_BEAM_DAMAGED)) continue;
      fprintf(out, "beam %d: %s", part.number, words->plain);
      return true;
    }
  }
  return false;
}

/* Puts the main reason for rejection: a defect, or the value farthest beyond its limit. */
static void put_reason(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  char defect[200];
  if (foil->foil->error[0]) {
    fg_html_text(out, foil->foil->error);
  } else if (fg_foil_defect(&analysis->lot->settings.design, foil->foil, defect, sizeof defect)) {
    fputs(defect, out);
  } else if (foil->verdict == FG_VERDICT_NOT_MEASURED && put_damage(out, foil->foil)) {
    return;
  } else if (foil->worst_row) {
    fputs(foil->worst_row->words, out);
    if (foil->worst_number)
      fprintf(out, " of %s %d", fg_lot_words_of(analysis)->one, foil->worst_number);
  }
}

static bool has_worst_value(const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  return foil->worst_row && isfinite(foil->worst_value) && !foil->foil->error[0] &&
         !fg_foil_defect(&analysis->lot->settings.design, foil->foil, NULL, 0);
}

/* Returns the decimals of the quantity, or more where its U would read 0.0000. */
static int margin_decimals(const fg_quantity *row, double expanded) {
  enum { MAX = 9 };
  if (!(expanded > 0) || !isfinite(expanded)) return row->decimals;
  int first = (int)-floor(log10(expanded)); /* place of the first digit */
  return first > MAX ? MAX : first > row->decimals ? first : row->decimals;
}

static void show_reason(FILE *out, const fg_subject *subject) {
  put_reason(out, lot_of(subject), subject->object);
}

static void show_worst_foil(FILE *out, const fg_subject *subject) {
  fputs("<b>", out);
  fg_lot_put_foil_link(out, lot_of(subject), subject->object);
  fputs("</b>", out);
}

/* Its page, or the place that links from elsewhere lead to. */
static void show_listed_foil(FILE *out, const fg_subject *subject) {
  const fg_lot_analysis *analysis = subject->whole;
  const fg_lot_foil *foil = subject->object;
  fprintf(out, "<span id=\"foil-%zu\">", (size_t)(foil - analysis->foils) + 1);
  if (analysis->pages && analysis->pages[foil->item])
    fg_lot_put_foil_link(out, analysis, foil);
  else
    fg_lot_put_label(out, analysis, foil);
  fputs("</span>", out);
}

static void show_scan(FILE *out, const fg_subject *subject) {
  fg_lot_put_scan(out, lot_of(subject), ((const fg_lot_foil *)subject->object)->item);
}

static void show_worst_value(FILE *out, const fg_subject *subject) {
  const fg_lot_foil *foil = subject->object;
  double expanded = FG_COVERAGE_FACTOR * foil->worst_u;
  if (!has_worst_value(lot_of(subject), foil)) {
    fputs("–", out);
    return;
  }
  int decimals = margin_decimals(foil->worst_row, expanded);
  fg_lot_put_decimals(out, foil->worst_value, decimals);
  if (isfinite(expanded)) {
    fputs(" ± ", out);
    fg_lot_put_decimals(out, expanded, decimals);
  }
  fprintf(out, " %s", foil->worst_row->unit);
}

static bool has_worst_limit(const fg_subject *subject) {
  const fg_lot_foil *foil = subject->object;
  return has_worst_value(lot_of(subject), foil) && isfinite(foil->worst_limit);
}

static void show_limit(FILE *out, const fg_subject *subject) {
  const fg_lot_foil *foil = subject->object;
  fg_lot_put_number(out, has_worst_limit(subject) ? foil->worst_limit : NAN, 6);
  if (has_worst_limit(subject)) fprintf(out, " %s", foil->worst_row->unit);
}

static void show_margin(FILE *out, const fg_subject *subject) {
  const fg_lot_foil *foil = subject->object;
  if (!has_worst_limit(subject)) {
    fputs("–", out);
    return;
  }
  int decimals = margin_decimals(foil->worst_row, FG_COVERAGE_FACTOR * foil->worst_u);
  fg_lot_put_decimals(out, fabs(foil->worst_margin), decimals);
  fprintf(out, " %s %s", foil->worst_row->unit, foil->worst_margin < 0 ? "beyond" : "within");
}

static size_t die_column_of(const fg_subject *subject) {
  const fg_lot *lot = lot_of(subject)->lot;
  return fg_manifest_column(&lot->manifest, lot->settings.die_column);
}

static const char *find_die_cell(const fg_subject *subject, char *buffer) {
  const fg_lot_foil *foil = subject->object;
  (void)buffer;
  return fg_manifest_cell(&lot_of(subject)->lot->manifest, foil->item, die_column_of(subject));
}

static const char *find_verdict_words(const fg_subject *subject, char *buffer) {
  fg_verdict verdict = ((const fg_lot_foil *)subject->object)->verdict;
  (void)buffer;
  return verdict == FG_VERDICT_UNDECIDED      ? "cannot tell"
         : verdict == FG_VERDICT_NOT_MEASURED ? "not measured"
         : verdict == FG_VERDICT_NONE         ? NULL
                                              : fg_verdict_word(verdict);
}

static const char *look_at_verdict(const fg_subject *subject) {
  return fg_verdict_word(((const fg_lot_foil *)subject->object)->verdict);
}

static const char *look_at_path(const fg_subject *subject) {
  (void)subject;
  return "words path";
}

static double count_foil_parts(const fg_subject *subject) {
  const fg_lot_foil *foil = subject->object;
  return (double)fg_part_count(foil->foil, lot_of(subject)->parts);
}

static double find_overall_radius(const fg_subject *subject) {
  return ((const fg_lot_foil *)subject->object)->foil->overall.radius_mm;
}

static const char *find_no_text(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return NULL;
}

static bool is_worst_table(const fg_subject *list) {
  return list->index == WORST_FOILS;
}

static bool is_foil_list(const fg_subject *list) {
  return list->index == LISTED_FOILS;
}

static bool has_die_column(const fg_subject *list) {
  return is_worst_table(list) && die_column_of(list) != FG_NO_COLUMN;
}

static bool lists_bumps(const fg_subject *list) {
  return is_foil_list(list) && fg_lot_has_no_beams(list);
}

static bool lists_beams(const fg_subject *list) {
  return is_foil_list(list) && fg_lot_has_beams(list);
}

static bool lists_radii(const fg_subject *list) {
  return is_foil_list(list) &&
         !fg_foil_traits_of(lot_of(list)->lot->settings.design.kind)->lies_flat;
}

#define CELL(heading_, show, ...)                                                                  \
  {                                                                                                \
    FG_TEXT_BY(heading_, find_no_text), .options = FG_MEMBER_NOT_IN_JSON, .heading = (heading_),   \
                                        .markup = (show), __VA_ARGS__                              \
  }

static const fg_member foil_columns[] = {
    CELL("foil", show_worst_foil, .page = {.rank = 1}, .look = look_at_path,
         .column = is_worst_table),
    CELL("foil", show_listed_foil, .page = {.rank = 1}, .look = look_at_path,
         .column = is_foil_list),
    CELL("scan", show_scan, .page = {.rank = 1, .words = true}, .look = look_at_path),
    {FG_TEXT_BY("die", find_die_cell), .named = true, .heading = "die", .page = {.rank = 1},
     .column = has_die_column},
    {FG_TEXT_BY("verdict", find_verdict_words), .heading = "verdict", .page = {.rank = 1},
     .look = look_at_verdict},
    {FG_COUNT_BY("bumps", count_foil_parts), .heading = "bumps", .page = {.rank = 1},
     .column = lists_bumps},
    {FG_COUNT_BY("beams", count_foil_parts), .heading = "beams", .page = {.rank = 1},
     .column = lists_beams},
    {FG_NUMBER_BY("overall.radius_mm", find_overall_radius), .heading = "R0\nmm",
     .page = {.rank = 1, .digits = 6}, .column = lists_radii},
    CELL("what is farthest", show_reason, .page = {.rank = 1, .words = true},
         .column = is_worst_table),
    CELL("what is farthest, or why not", show_reason, .page = {.rank = 1, .words = true},
         .column = is_foil_list),
    CELL("value ± U", show_worst_value, .page = {.rank = 1}),
    CELL("nearest\nlimit", show_limit, .page = {.rank = 1}),
    CELL("margin", show_margin, .page = {.rank = 1}),
};

static bool find_worst_foil(const fg_subject *list, size_t i, fg_subject *element) {
  if (i >= FG_LOT_WORST) return false;
  element->object = lot_of(list)->worst[i];
  return true;
}

/* Those that do not pass come first. */
static bool find_listed_foil(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = lot_of(list);
  if (i >= 2 * analysis->foil_count) return false;
  const fg_lot_foil *foil = &analysis->foils[i % analysis->foil_count];
  bool good = i >= analysis->foil_count;
  element->object = foil->row && fg_lot_foil_is_good(foil) == good ? foil : NULL;
  return true;
}

void fg_lot_put_worst_table(FILE *out, const fg_lot_analysis *analysis) {
  static const fg_members members = FG_MEMBERS(foil_columns);
  fg_html_table(out, &members, &(fg_subject){.whole = analysis, .index = WORST_FOILS},
                find_worst_foil);
}

void fg_lot_put_foil_table(FILE *out, const fg_lot_analysis *analysis) {
  static const fg_members members = {
      .rows = foil_columns, .count = sizeof foil_columns / sizeof *foil_columns, .frame = "lots"};
  fg_html_table(out, &members, &(fg_subject){.whole = analysis, .index = LISTED_FOILS},
                find_listed_foil);
}
