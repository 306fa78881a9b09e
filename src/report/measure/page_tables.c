/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of a page: bumps, discs, the whole foil, with their tolerances. */
#include <math.h>
#include <string.h>

#include "quantity/quantity_rows.h"
#include "report/measure/foil_parts.h"
#include "report/measure/page_tables.h"

enum { PAGE_COLUMNS_MAX = FG_QUANTITY_SHOWN_MAX + FG_TOLERANCES_MAX };

static const fg_tolerance *find_tolerance(const fg_design *design, const char *quantity) {
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (!strcmp(design->tolerances[i].quantity, quantity)) return &design->tolerances[i];
  return NULL;
}

static void put_limits(FILE *out, const fg_tolerance *tolerance) {
  if (!tolerance) return;
  if (isfinite(tolerance->lower) && isfinite(tolerance->upper))
    fprintf(out, "%.6g … %.6g", tolerance->lower, tolerance->upper);
  else if (isfinite(tolerance->lower))
    fprintf(out, "≥ %.6g", tolerance->lower);
  else
    fprintf(out, "≤ %.6g", tolerance->upper);
}

/* Writes "3.39288 ± 0.00042", or "–" when it is not known. */
static void put_quantity_value(FILE *out, const fg_quantity *row, const void *object) {
  double value = fg_quantity_value(row, object), u = fg_quantity_uncertainty(row, object);
  int decimals = row->kind == FG_QUANTITY_COUNT ? 0 : fg_report_decimals(row, u);
  if (!isfinite(value)) {
    fputs("–", out);
    return;
  }
  fprintf(out, "%s%.*f", value <= -0.5 * pow(10, -decimals) ? "−" : "", decimals, fabs(value));
  if (isfinite(u)) fprintf(out, " <i>± %.*f</i>", decimals, FG_COVERAGE_FACTOR * u);
}

/* `judged`: the values are those of a part of the design. */
static void put_part_cell(FILE *out, const fg_design *design, const fg_quantity *row,
                          const void *object, bool judged) {
  const fg_tolerance *tolerance = find_tolerance(design, row->name);
  fg_verdict verdict = FG_VERDICT_NONE;
  if (tolerance && judged)
    verdict = fg_judge_measured(design, tolerance, row, fg_quantity_value(row, object),
                                fg_quantity_uncertainty(row, object));
  fprintf(out, "<td class=\"%s\">", fg_verdict_word(verdict));
  put_quantity_value(out, row, object);
  fputs("</td>", out);
}

static void put_flag_cell(FILE *out, const fg_flag_words *words, unsigned flags,
                          unsigned findings) {
  const char *separator = "";
  fputs("<td class=\"words\">", out);
  for (; words->name; words++) {
    if (!(flags & words->flag)) continue;
    fprintf(out, "%s%s", separator, words->plain);
    separator = "; ";
  }
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++) {
    if (!(findings & found->finding)) continue;
    fprintf(out, "%s%s", separator, found->name);
    separator = "; ";
  }
  fputs("</td></tr>\n", out);
}

/* Columns that the table always has, then those with a tolerance that it has not. */
static size_t choose_columns(const fg_design *design, fg_quantity_owner owner,
                             const fg_quantity *columns[PAGE_COLUMNS_MAX]) {
  size_t used = fg_quantity_shown(owner, FG_QUANTITY_ON_PAGE, design->kind, columns);
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_quantity *row = fg_quantity_find(owner, design->tolerances[i].quantity);
    bool there = row == NULL;
    for (size_t k = 0; k < used; k++)
      there = there || columns[k] == row;
    if (!there) columns[used++] = row;
  }
  return used;
}

typedef struct table_rows {
  fg_quantity_owner owner;
  const char *title;
  const char *objects;
  size_t count, size;
  const fg_foil *foil; /* of the bumps or beams; NULL for discs */
} table_rows;

static void put_table_head(FILE *out, const fg_design *design, const table_rows *rows,
                           const fg_quantity *const *columns, size_t count) {
  bool limits = false;
  fprintf(out, "<div class=\"scroll\"><table>\n<thead><tr><th>%s</th>", rows->title);
  for (size_t i = 0; i < count; i++) {
    fprintf(out, "<th title=\"%s\">%s<br>%s</th>", columns[i]->words, columns[i]->symbol,
            columns[i]->unit);
    limits = limits || find_tolerance(design, columns[i]->name);
  }
  fputs("<td></td></tr></thead>\n<tbody>\n", out);
  if (!limits) return;
  fputs("<tr class=\"limits\"><td>tolerance</td>", out);
  for (size_t i = 0; i < count; i++) {
    fputs("<td>", out);
    put_limits(out, find_tolerance(design, columns[i]->name));
    fputs("</td>", out);
  }
  fputs("<td></td></tr>\n", out);
}

/* Writes one cell in place of the values of a part that could not be fitted. */
static void put_unfitted(FILE *out, int number, size_t columns) {
  fprintf(out,
          "<tr class=\"unfitted\"><td>%d</td><td class=\"words not_measured\" colspan=\"%zu\">"
          "not fitted: it has no values</td>",
          number, columns);
}

/* State of a row: the part's number, flags and object, for every owner. */
typedef struct row_state {
  int number;
  bool unfitted;
  unsigned flags;
  const fg_flag_words *words;
  unsigned findings; /* fg_picture_finding; a foil tells its own once, above its parts */
} row_state;

static row_state state_of(const fg_design *design, const table_rows *rows, const void *object) {
  const fg_bump *bump = object;
  const fg_beam *beam = object;
  const fg_disc *disc = object;
  if (rows->owner == FG_QUANTITY_OF_BEAM)
    return (row_state){beam->number, beam->flags & FG_BEAM_NOT_FITTED,
                       fg_beam_flags(design, rows->foil, beam), fg_beam_flag_words(), 0};
  if (rows->owner == FG_QUANTITY_OF_BUMP)
    return (row_state){bump->number, bump->flags & FG_BUMP_NOT_FITTED,
                       fg_bump_flags(design, rows->foil, bump), fg_bump_flag_words(), 0};
  return (row_state){disc->number, false, fg_disc_flags(design, disc), fg_bump_flag_words(),
                     disc->picture.findings};
}

/* Explains the symbols of the heads. */
static void put_key(FILE *out, const fg_quantity *const *columns, size_t count) {
  fputs("<p class=\"note symbols\">", out);
  for (size_t i = 0; i < count; i++)
    fprintf(out, "%s<b>%s</b> %s", i ? "; " : "", columns[i]->symbol, columns[i]->words);
  fputs(". The small number below a value is its ±.</p>\n", out);
}

static void put_part_table(FILE *out, const fg_design *design, const table_rows *rows) {
  const fg_quantity *columns[PAGE_COLUMNS_MAX];
  size_t count = choose_columns(design, rows->owner, columns);
  put_key(out, columns, count);
  put_table_head(out, design, rows, columns, count);
  for (size_t i = 0; i < rows->count; i++) {
    const void *object = rows->objects + i * rows->size;
    const row_state state = state_of(design, rows, object);
    if (state.unfitted)
      put_unfitted(out, state.number, count);
    else
      fprintf(out, "<tr><td>%d</td>", state.number);
    for (size_t k = 0; k < count && !state.unfitted; k++)
      put_part_cell(out, design, columns[k], object,
                    !rows->foil || fg_foil_is_measured(rows->foil));
    put_flag_cell(out, state.words, state.flags, state.findings);
  }
  fputs("</tbody></table></div>\n", out);
}

void fg_html_foil_table(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_quantity *rows[PAGE_COLUMNS_MAX];
  size_t count = choose_columns(design, FG_QUANTITY_OF_FOIL, rows);
  fputs("<h2>The whole foil</h2>\n<div class=\"scroll\"><table><thead><tr><th>quantity</th>"
        "<th>value</th><th>unit</th><th>tolerance</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < count; i++) {
    fprintf(out, "<tr><td>%s</td>", rows[i]->words);
    put_part_cell(out, design, rows[i], foil, fg_foil_is_measured(foil));
    fprintf(out, "<td>%s</td><td>", rows[i]->unit);
    put_limits(out, find_tolerance(design, rows[i]->name));
    fputs("</td></tr>\n", out);
  }
  fputs("</tbody></table></div>\n", out);
}

void fg_html_part_table(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  const bool beams = parts.owner == FG_QUANTITY_OF_BEAM;
  const table_rows rows = {parts.owner,
                           parts.name,
                           beams ? (const char *)foil->beams : (const char *)foil->bumps,
                           parts.count,
                           beams ? sizeof *foil->beams : sizeof *foil->bumps,
                           foil};
  put_part_table(out, design, &rows);
}

void fg_html_disc_table(FILE *out, const fg_design *design, const fg_measurement *measurement) {
  const table_rows rows = {
      FG_QUANTITY_OF_DISC,        "disc", (const char *)measurement->discs, measurement->disc_count,
      sizeof *measurement->discs, NULL};
  put_part_table(out, design, &rows);
}
