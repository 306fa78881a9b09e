/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values, elements and columns of members. */
#include "core/member.h"

#include <math.h>
#include <string.h>

#include "foilgauge/report.h"

/* U below 1e-5 of its unit, a hundredth of a micrometre, is shown with one digit in place of two.
 */
enum { DECIMALS_FINE = 5, DECIMALS_MAX = 7 };

static const void *place_at(const fg_subject *subject, size_t offset) {
  return (const char *)subject->object + offset;
}

bool fg_member_is_number(const fg_member *member) {
  return member->number || member->kind <= FG_MEMBER_SEED;
}

double fg_member_value(const fg_member *member, const fg_subject *subject) {
  if (member->number) return member->number(subject);
  const void *place = place_at(subject, member->offset);
  switch (member->kind) {
  case FG_MEMBER_NUMBER:
    return *(const double *)place;
  case FG_MEMBER_COUNT:
    return (double)*(const size_t *)place;
  case FG_MEMBER_INTEGER:
    return *(const int *)place;
  case FG_MEMBER_UNSIGNED:
    return *(const unsigned *)place;
  case FG_MEMBER_SEED:
    return (double)*(const uint64_t *)place;
  case FG_MEMBER_FLAG:
    return *(const bool *)place;
  default:
    return NAN;
  }
}

bool fg_member_has_u(const fg_member *member) {
  return member->kind == FG_MEMBER_NUMBER && (member->u_offset || member->u);
}

double fg_member_u(const fg_member *member, const fg_subject *subject) {
  if (!fg_member_has_u(member)) return NAN;
  if (member->u) return member->u(subject);
  return *(const double *)place_at(subject, member->u_offset);
}

const char *fg_member_choice_at(const fg_member *member, size_t i) {
  if (member->choice_at) return member->choice_at(i);
  return member->choices ? member->choices[i] : NULL;
}

static const char *find_word(const fg_member *member, const fg_subject *subject) {
  int word = member->word ? member->word(subject) : *(const int *)place_at(subject, member->offset);
  return word < 0 ? NULL : fg_member_choice_at(member, (size_t)word);
}

const char *fg_member_text(const fg_member *member, const fg_subject *subject,
                           char buffer[FG_MEMBER_TEXT_MAX]) {
  const char *text = NULL;
  if (member->text)
    text = member->text(subject, buffer);
  else if (member->kind == FG_MEMBER_TEXT)
    text = place_at(subject, member->offset);
  else if (member->kind == FG_MEMBER_STRING)
    text = *(const char *const *)place_at(subject, member->offset);
  else if (member->kind == FG_MEMBER_WORD)
    text = find_word(member, subject);
  return text && !*text && member->options & FG_MEMBER_EMPTY_IS_NULL ? NULL : text;
}

bool fg_member_is_present(const fg_member *member, const fg_subject *subject) {
  return !member->present || member->present(subject);
}

fg_subject fg_member_part(const fg_member *member, const fg_subject *subject) {
  if (member->part) return member->part(subject);
  const void *place = place_at(subject, member->offset);
  return (fg_subject){.object = member->pointed ? *(const void *const *)place : place,
                      .whole = subject->whole,
                      .index = subject->index};
}

bool fg_member_element_at(const fg_member *member, const fg_subject *subject, size_t i,
                          fg_subject *element) {
  *element = (fg_subject){.whole = subject->whole, .index = i};
  if (member->element) return member->element(subject, i, element);
  const char *first = place_at(subject, member->offset);
  if (i >= *(const size_t *)place_at(subject, member->count_offset)) return false;
  if (member->pointed) first = *(const char *const *)(const void *)first;
  element->object = first + i * member->stride;
  return true;
}

bool fg_list_next(const fg_subject *list, fg_member_element *element, size_t i, fg_subject *found) {
  *found = (fg_subject){.whole = list->whole, .index = i};
  return element(list, i, found);
}

const fg_member_column *fg_member_column_of(const fg_member *member, fg_member_medium medium) {
  return medium == FG_ON_CSV    ? &member->csv
         : medium == FG_ON_PAGE ? &member->page
                                : &member->terminal;
}

const char *fg_member_heading(const fg_member *member, fg_member_medium medium) {
  const char *heading = fg_member_column_of(member, medium)->heading;
  if (!heading) heading = medium == FG_ON_CSV ? member->name : member->heading;
  return heading ? heading : "";
}

static void collect_columns(const fg_members *members, fg_member_medium medium,
                            const fg_subject *list, fg_member_columns *columns) {
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i];
    if (row->kind == FG_MEMBER_SAME && row->members && !row->part)
      collect_columns(row->members, medium, list, columns);
    else if (fg_member_column_of(row, medium)->rank && columns->count < FG_MEMBER_COLUMNS_MAX &&
             (medium == FG_ON_CSV || !row->column || row->column(list)))
      columns->rows[columns->count++] = row;
  }
}

void fg_member_columns_of(const fg_members *members, fg_member_medium medium,
                          const fg_subject *list, fg_member_columns *columns) {
  columns->count = 0;
  columns->members = members;
  collect_columns(members, medium, list, columns);
  for (size_t i = 1; i < columns->count; i++) { /* insertion: stable */
    const fg_member *row = columns->rows[i];
    size_t k = i;
    int rank = fg_member_column_of(row, medium)->rank;
    for (; k > 0 && fg_member_column_of(columns->rows[k - 1], medium)->rank > rank; k--)
      columns->rows[k] = columns->rows[k - 1];
    columns->rows[k] = row;
  }
}

int fg_decimals_by_u(int min, double u) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!(expanded > 0)) return min;
  int decimals = 1 - (int)floor(log10(expanded));
  if (decimals > DECIMALS_FINE) decimals = (int)fmax(DECIMALS_FINE, decimals - 1);
  if (decimals < min) return min;
  return decimals > DECIMALS_MAX ? DECIMALS_MAX : decimals;
}

static double scale_of(const fg_member_column *column) {
  return column->scale != 0 ? column->scale : 1;
}

static int decimals_of(const fg_member *member, const fg_member_column *column,
                       const fg_subject *subject) {
  if (member->kind != FG_MEMBER_NUMBER) return 0;
  if (member->decimals_by) return member->decimals_by(subject);
  if (!column->by_u) return column->decimals;
  return fg_decimals_by_u(column->decimals, scale_of(column) * fg_member_u(member, subject));
}

void fg_member_show(const fg_member *member, fg_member_medium medium, const fg_subject *subject,
                    char *text, size_t size) {
  const fg_member_column *column = fg_member_column_of(member, medium);
  const char *unknown = medium == FG_ON_PAGE ? "–" : "-", *unit = column->unit ? column->unit : "";
  char buffer[FG_MEMBER_TEXT_MAX];
  if (member->kind != FG_MEMBER_FLAG && !fg_member_is_number(member)) {
    const char *words = fg_member_text(member, subject, buffer);
    snprintf(text, size, "%s", words ? words : column->words ? "" : unknown);
    return;
  }
  double value = scale_of(column) * fg_member_value(member, subject);
  if (member->kind == FG_MEMBER_FLAG && isfinite(value))
    snprintf(text, size, "%s", value != 0 ? "yes" : "no");
  else if (!isfinite(value))
    snprintf(text, size, "%s", unknown);
  else if (column->min > 0 && value < column->min)
    snprintf(text, size, "< %.*g", column->digits, column->min);
  else if (column->digits)
    snprintf(text, size, column->plus ? "%+.*g%s" : "%.*g%s", column->digits, value, unit);
  else
    snprintf(text, size, column->plus ? "%+.*f%s" : "%.*f%s", decimals_of(member, column, subject),
             value, unit);
}

void fg_member_show_u(const fg_member *member, fg_member_medium medium, const fg_subject *subject,
                      char *text, size_t size) {
  const fg_member_column *column = fg_member_column_of(member, medium);
  double u = fg_member_u(member, subject);
  text[0] = '\0';
  if (column->no_u || !isfinite(u) || !isfinite(fg_member_value(member, subject))) return;
  double expanded = FG_COVERAGE_FACTOR * scale_of(column) * u;
  if (column->digits)
    snprintf(text, size, "%.*g", column->digits, expanded);
  else
    snprintf(text, size, "%.*f", decimals_of(member, column, subject), expanded);
}
