/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/columns.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/text.h"

typedef struct unit {
  const char *word;
  double scale;
} unit;

enum { UNITS_MAX = 12 }; /* and an empty one */

typedef struct measured_row {
  const char *name;
  unit units[UNITS_MAX];
  const char *wanted;
} measured_row;

#define FORCE_UNITS                                                                                \
  {"N", 1}, {"n", 1}, {"mN", 1e-3}, {"kN", 1e3}, {"kn", 1e3}, {"kgf", 9.80665}, {"kp", 9.80665}, { \
    "lbf", 4.4482216152605                                                                         \
  }

static const measured_row rows[FG_LOAD_MEASURED] = {
    [FG_LOAD_AZIMUTH] = {"azimuth",
                         {{"deg", 1}, {"°", 1}, {"rad", 180 / M_PI}},
                         "azimuth_deg or azimuth_rad"},
    [FG_LOAD_FORCE] = {"force",
                       {FORCE_UNITS},
                       "force_N, force_mN, force_kN, force_kgf or force_lbf"},
    [FG_LOAD_DISPLACEMENT] =
        {"displacement",
         {{"mm", 1},
          {"um", 1e-3},
          {"\xc2\xb5m", 1e-3},
          {"\xce\xbcm", 1e-3},
          {"m", 1e3},
          {"nm", 1e-6},
          {"mil", 0.0254},
          {"in", 25.4}},
         "displacement_mm, displacement_um, displacement_nm, displacement_m, displacement_mil or "
         "displacement_in"},
    [FG_LOAD_TIME] = {"time", {{"s", 1}, {"ms", 1e-3}, {"min", 60}}, "time_s, time_ms or time_min"},
    [FG_LOAD_WEIGHT] = {"dead weight",
                        {FORCE_UNITS},
                        "dead_weight_N, dead_weight_mN, dead_weight_kN, dead_weight_kgf or "
                        "dead_weight_lbf"},
    [FG_LOAD_TORQUE] = {"torque",
                        {{"Nmm", 1}, {"nmm", 1}, {"Nm", 1e3}, {"nm", 1e3}, {"mNm", 1}},
                        "torque_N_mm, torque_N_m or torque_mN_m"},
};

typedef enum table_kind { LOAD_TABLE, BREAK_AWAY_TABLE } table_kind;

static bool is_of_table(int which, table_kind kind) {
  if (which == FG_LOAD_FORCE) return true;
  return (which == FG_LOAD_WEIGHT || which == FG_LOAD_TORQUE) == (kind == BREAK_AWAY_TABLE);
}

static bool is_separator(char c) {
  return c == ' ' || c == '_';
}

/* Returns the text after the quantity's word, in which blanks may be underlines; NULL: another
 * word. */
static const char *skip_word(const char *name, const char *word) {
  for (; *word; word++, name++) {
    bool same = is_separator(*word)
                    ? is_separator(*name)
                    : tolower((unsigned char)*word) == tolower((unsigned char)*name);
    if (!same) return NULL;
  }
  return isalnum((unsigned char)*name) ? NULL : name;
}

/* Returns the text after the quantity's word in a column's name, without blanks, underlines and
 * brackets; NULL: another quantity. Units of torque are products: signs between their parts are
 * removed. */
static const char *unit_text(const char *name, int which, char *text, size_t size) {
  const char *from = skip_word(name, rows[which].name);
  if (!from) return NULL;
  from += strspn(from, " _[(/");
  bool product = which == FG_LOAD_TORQUE;
  size_t count = strcspn(from, product ? "])" : " ])"), length = 0;
  fg_text_clip(text, size, "%.*s", (int)count, from);
  for (const char *c = text; *c && product; c++)
    if (!strchr(" _.*-", *c)) text[length++] = *c;
  if (product) text[length] = '\0';
  return text;
}

static fg_status fail_unit(fg_context *ctx, const fg_table *table, const char *name,
                           const measured_row *row, const char *text) {
  bool force = row == &rows[FG_LOAD_FORCE] || row == &rows[FG_LOAD_WEIGHT];
  bool mass =
      force && (!strncasecmp(text, "kg", 2) || !strncasecmp(text, "lb", 2) || !strcmp(text, "g"));
  if (!*text)
    return fg_fail(ctx, FG_ERR_DATA, "%s: the column '%s' has no unit; call it %s", table->source,
                   name, row->wanted);
  return fg_fail(ctx, FG_ERR_DATA, "%s: the column '%s': '%s' is no unit of %s%s; it must be %s",
                 table->source, name, text, row->name,
                 mass ? " but of mass: multiply kilograms by 9.80665, pounds by 4.44822 for newtons"
                      : "",
                 row->wanted);
}

static fg_status assign_column(fg_context *ctx, const fg_table *table, size_t number,
                               fg_load_measured which, const char *text, fg_load_columns *columns) {
  const char *name = table->column[number].name;
  const unit *u = rows[which].units;
  while (u->word && strcmp(u->word, text) != 0)
    u++;
  if (!u->word) return fail_unit(ctx, table, name, &rows[which], text);
  if (columns->number[which])
    return fg_fail(ctx, FG_ERR_DATA, "%s: two columns of %s, '%s' is the second; leave one",
                   table->source, rows[which].name, name);
  FG_TRY(fg_table_check(ctx, table, name));
  FG_TRY(fg_table_numbers(ctx, table, name, &columns->number[which]));
  columns->scale[which] = u->scale;
  return FG_OK;
}

static bool is_word(const fg_column *column, const char *word, const fg_column **found) {
  if (strcasecmp(column->name, word) != 0) return false;
  *found = column;
  return true;
}

static fg_status sort_column(fg_context *ctx, const fg_table *table, size_t number, table_kind kind,
                             fg_load_columns *columns) {
  const fg_column *column = &table->column[number], *repeat;
  char text[32];
  for (int which = 0; which < FG_LOAD_MEASURED; which++)
    if (is_of_table(which, kind) && unit_text(column->name, which, text, sizeof text))
      return assign_column(ctx, table, number, (fg_load_measured)which, text, columns);
  if (is_word(column, "bearing", &columns->bearing)) return FG_OK;
  if (kind == LOAD_TABLE &&
      (is_word(column, "cycle", &columns->cycle) || is_word(column, "pad", &columns->pad)))
    return FG_OK;
  if (kind == BREAK_AWAY_TABLE && is_word(column, "repeat", &repeat)) return FG_OK;
  return fg_text_append(ctx, &columns->not_read, "%s%s", columns->not_read ? ", " : "",
                        column->name);
}

fg_status fg_load_columns_find(fg_context *ctx, const fg_table *table, bool azimuth_said,
                               fg_load_columns *columns) {
  *columns = (fg_load_columns){0};
  for (size_t i = 0; i < table->columns; i++)
    FG_TRY(sort_column(ctx, table, i, LOAD_TABLE, columns));
  for (int which = 0; which < FG_LOAD_TIME; which++) {
    if (columns->number[which] || (which == FG_LOAD_AZIMUTH && azimuth_said)) continue;
    return fg_fail(ctx, FG_ERR_DATA, "%s: no column of the %s; it must be called %s%s",
                   table->source, rows[which].name, rows[which].wanted,
                   which == FG_LOAD_AZIMUTH ? ", or say --azimuth DEG before the file" : "");
  }
  if (columns->cycle)
    FG_TRY(fg_table_numbers(ctx, table, columns->cycle->name, &(const fg_extended *){NULL}));
  return FG_OK;
}

fg_status fg_load_columns_find_break_away(fg_context *ctx, const fg_table *table,
                                          fg_load_columns *columns) {
  *columns = (fg_load_columns){0};
  for (size_t i = 0; i < table->columns; i++)
    FG_TRY(sort_column(ctx, table, i, BREAK_AWAY_TABLE, columns));
  if (!columns->number[FG_LOAD_WEIGHT])
    return fg_fail(ctx, FG_ERR_DATA, "%s: no column of the dead weight; it must be called %s",
                   table->source, rows[FG_LOAD_WEIGHT].wanted);
  if (!columns->number[FG_LOAD_TORQUE] && !columns->number[FG_LOAD_FORCE])
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: no column of the torque or of the force at break-away; it must be called "
                   "%s, or %s",
                   table->source, rows[FG_LOAD_TORQUE].wanted, rows[FG_LOAD_FORCE].wanted);
  if (columns->number[FG_LOAD_TORQUE] && columns->number[FG_LOAD_FORCE])
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: a torque and a force at break-away; one follows from the other, leave one",
                   table->source);
  return FG_OK;
}

fg_status fg_load_columns_text(fg_context *ctx, const fg_table *table, const fg_column *column,
                               size_t row, char *text, size_t size) {
  size_t mark = column->word ? column->word[row] : FG_TABLE_NOT_A_WORD;
  if (mark == FG_TABLE_MISSING)
    return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu (line %zu): the column '%s' is empty",
                   table->source, row + 1, table->line[row], column->name);
  if (mark == FG_TABLE_NOT_A_WORD)
    fg_text_clip(text, size, "%.10g", column->number[row].value);
  else
    fg_text_clip(text, size, "%s", column->words[mark]);
  return FG_OK;
}
