/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "die/header.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { LINE_MAX_BYTES = 300 };

typedef struct unit_word {
  const char *word;
  fg_die_unit unit;
} unit_word;

/* µ as U+00B5, U+03BC and in Latin-1. */
static const unit_word unit_words[] = {
    {"mm", FG_DIE_MM},          {"millimetre", FG_DIE_MM},  {"millimeter", FG_DIE_MM},
    {"millimetres", FG_DIE_MM}, {"millimeters", FG_DIE_MM}, {"um", FG_DIE_UM},
    {"\xc2\xb5m", FG_DIE_UM},   {"\xce\xbcm", FG_DIE_UM},   {"\xb5m", FG_DIE_UM},
    {"mum", FG_DIE_UM},         {"micron", FG_DIE_UM},      {"microns", FG_DIE_UM},
    {"micrometre", FG_DIE_UM},  {"micrometer", FG_DIE_UM},  {"micrometres", FG_DIE_UM},
    {"micrometers", FG_DIE_UM}, {"mikrometer", FG_DIE_UM},  {"nm", FG_DIE_NM},
    {"nanometre", FG_DIE_NM},   {"nanometer", FG_DIE_NM},   {NULL, FG_DIE_UNIT_NONE},
};

static const char *const inch_words[] = {"inch", "inches", "in", "mil", "mils", NULL};

static bool is_word_byte(char c) {
  return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* The next word (letters, digits, bytes beyond ASCII) from *at on; false at the end. */
static bool next_word(const char **at, const char *end, fg_die_field *word) {
  const char *from = *at;
  while (from < end && !is_word_byte(*from))
    from++;
  const char *to = from;
  while (to < end && is_word_byte(*to))
    to++;
  *at = to;
  *word = (fg_die_field){from, (size_t)(to - from)};
  return to > from;
}

static bool word_is(const fg_die_field *word, const char *text) {
  return word->length == strlen(text) && !strncasecmp(word->text, text, word->length);
}

static fg_die_unit unit_of(const fg_die_field *word) {
  for (const unit_word *row = unit_words; row->word; row++)
    if (word_is(word, row->word)) return row->unit;
  return FG_DIE_UNIT_NONE;
}

static bool is_inch(const fg_die_field *word) {
  for (size_t i = 0; inch_words[i]; i++)
    if (word_is(word, inch_words[i])) return true;
  return false;
}

/* The last unit among the words of a text; "in" may be a word as well. */
static fg_die_unit unit_in(const char *text, size_t length, bool *inch) {
  const char *at = text, *end = text + length;
  fg_die_unit found = FG_DIE_UNIT_NONE;
  fg_die_field word;
  while (next_word(&at, end, &word)) {
    fg_die_unit unit = unit_of(&word);
    if (unit) found = unit;
    if (inch && is_inch(&word)) *inch = true;
  }
  if (found && inch) *inch = false;
  return found;
}

static bool holds(const char *text, size_t length, const char *what) {
  size_t size = strlen(what);
  for (size_t i = 0; i + size <= length; i++)
    if (!strncasecmp(text + i, what, size)) return true;
  return false;
}

const char *fg_die_half_in(const char *text, size_t length) {
  bool concave = holds(text, length, "concav") || holds(text, length, "konkav");
  bool convex = holds(text, length, "convex") || holds(text, length, "konvex");
  if (concave == convex) return NULL;
  return fg_die_half_word(concave ? FG_DIE_CONCAVE : FG_DIE_CONVEX);
}

/* Returns the axis named by the first word of a column's heading: 0 x, 1 z, -1 neither. */
static int axis_of(const char *text, size_t length) {
  static const char *const names[2][6] = {{"x", "length", "distance", "position", "lateral", NULL},
                                          {"z", "height", "profile", "depth", "vertical", NULL}};
  const char *at = text;
  fg_die_field word;
  if (!next_word(&at, text + length, &word)) return -1;
  for (int axis = 0; axis < 2; axis++)
    for (size_t i = 0; names[axis][i]; i++)
      if (word_is(&word, names[axis][i])) return axis;
  return -1;
}

static void set_unit(fg_die_unit unit, fg_die_unit *into) {
  if (unit) *into = unit;
}

/* "Unit: mm", "Z-Unit = um", "X units mm". */
static void read_unit_line(const char *line, size_t length, fg_die_header *header) {
  const char *at = line;
  fg_die_field word;
  bool x = false, z = false;
  while (next_word(&at, line + length, &word)) {
    x = x || word_is(&word, "x");
    z = z || word_is(&word, "z");
  }
  fg_die_unit unit = unit_in(line, length, &header->other_unit);
  if (x || !z) set_unit(unit, &header->unit[0]);
  if (z || !x) set_unit(unit, &header->unit[1]);
}

/* Reads headings that name both axes: "X [mm]; Z [µm]". When blanks separate, a heading and its
 * unit are two fields. */
static bool read_names(const fg_die_field *fields, size_t count, size_t columns,
                       fg_die_header *header) {
  size_t column[2] = {0, 0};
  fg_die_unit unit[2] = {FG_DIE_UNIT_NONE, FG_DIE_UNIT_NONE};
  int axis = -1;
  for (size_t i = 0; i < count && i < FG_DIE_FIELDS_MAX; i++) {
    int here = axis_of(fields[i].text, fields[i].length);
    if (here >= 0 && !column[here]) column[here] = i + 1;
    if (here >= 0 || count == columns) axis = here;
    if (axis >= 0)
      set_unit(unit_in(fields[i].text, fields[i].length, &header->other_unit), &unit[axis]);
  }
  if (!column[0] || !column[1]) return false;
  for (int k = 0; k < 2; k++) {
    if (count == columns) header->column[k] = column[k];
    set_unit(unit[k], &header->unit[k]);
  }
  return true;
}

/* A line of units alone, under the names: "mm; µm". */
static void read_units(const fg_die_field *fields, size_t count, fg_die_header *header) {
  for (size_t i = 0; i < count; i++) {
    const char *at = fields[i].text;
    fg_die_field word;
    if (!next_word(&at, fields[i].text + fields[i].length, &word) || !unit_of(&word)) return;
  }
  for (int axis = 0; axis < 2; axis++) {
    size_t column = header->column[axis] ? header->column[axis] - 1 : (size_t)axis;
    set_unit(unit_in(fields[column].text, fields[column].length, NULL), &header->unit[axis]);
  }
}

static void read_headings(const char *line, size_t length, char separator, size_t columns,
                          fg_die_header *header) {
  fg_die_field fields[FG_DIE_FIELDS_MAX];
  size_t count = fg_die_split(line, line + length, separator, fields);
  if (read_names(fields, count, columns, header)) return;
  if (count == columns && count >= 2 && count <= FG_DIE_FIELDS_MAX)
    read_units(fields, count, header);
}

/* The first number of a line, comma or point; NaN without one. */
static double number_in(const char *line, size_t length) {
  for (size_t i = 0; i < length; i++) {
    if (!isdigit((unsigned char)line[i])) continue;
    char text[32];
    size_t n = 0;
    for (; i + n < length && n + 1 < sizeof text && strchr("0123456789.,", line[i + n]); n++)
      text[n] = line[i + n] == ',' ? '.' : line[i + n];
    text[n] = '\0';
    return strtod(text, NULL);
  }
  return NAN;
}

/* "Tip radius: 2 µm", "Stylus radius 0.005 mm", "Tastspitzenradius: 2 µm" */
static void read_tip(const char *line, size_t length, fg_die_header *header) {
  bool tip =
      holds(line, length, "tip") || holds(line, length, "stylus") || holds(line, length, "tast");
  if (!tip || !holds(line, length, "radius")) return;
  fg_die_unit unit = unit_in(line, length, NULL);
  double value = number_in(line, length);
  if (!isfinite(value) || !unit) return;
  header->tip_um = value * (unit == FG_DIE_MM ? 1000 : unit == FG_DIE_NM ? 0.001 : 1);
}

static void read_points(const char *line, size_t length, fg_die_header *header) {
  bool said = holds(line, length, "number of points") || holds(line, length, "data points") ||
              holds(line, length, "no. of points") || holds(line, length, "points:") ||
              holds(line, length, "points=") || holds(line, length, "points =") ||
              holds(line, length, "samples") || holds(line, length, "anzahl");
  double value = said ? number_in(line, length) : NAN;
  if (value >= 1 && value < 1e9) header->points = (size_t)value;
}

static void read_line(const char *line, size_t length, char separator, size_t columns,
                      fg_die_header *header) {
  const char *half = fg_die_half_in(line, length);
  if (half) header->half = half;
  read_tip(line, length, header);
  read_points(line, length, header);
  if (holds(line, length, "unit") || holds(line, length, "einheit"))
    read_unit_line(line, length, header);
  else
    read_headings(line, length, separator, columns, header);
}

void fg_die_header_read(const char *text, const char *data, char separator, size_t columns,
                        fg_die_header *header) {
  *header = (fg_die_header){.tip_um = NAN};
  for (const char *at = text; at < data; at = fg_die_line_next(at)) {
    size_t length = (size_t)(fg_die_line_end(at) - at);
    if (length && length <= LINE_MAX_BYTES) read_line(at, length, separator, columns, header);
  }
}
