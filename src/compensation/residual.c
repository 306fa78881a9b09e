/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of the springback of every bump, in percent: the declared model is the law without terms
 * for single bumps, which is the mean of each set and its dependence on the die's radius. The
 * loop's rows are bumps, its groups foils; columns are those that all lots' manifests have. */
#include "compensation/residual.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/file.h"
#include "foilgauge/loop_table.h"
#include "foilgauge/lot_table.h"

static const char response[] = "springback_pct", declared[] = "predicted_pct";

enum { CELL_TEXT = 200, LOOP_MINUTES = 2, LOOP_MEBIBYTES = 512, ROWS_MIN = 12 };

/* Lots with their tables; a lot of several sets stands once. */
typedef struct springback_lots {
  const fg_springback_law *law;
  double exponent;
  fg_lot_table table[FG_COMPENSATION_SETS];
  size_t set[FG_COMPENSATION_SETS]; /* first set of the lot */
  size_t count;
} springback_lots;

static bool is_unchanged(const fg_lot_table *table, const fg_formed_set *set) {
  return !strcmp(table->sha256[0], set->sha256);
}

static fg_status read_lot_tables(fg_context *ctx, springback_lots *lots) {
  const fg_lot_table_options options = {.quantity = "radius_mm"};
  for (size_t i = 0; i < lots->law->sets; i++) {
    const fg_formed_set *set = &lots->law->set[i];
    fg_lot_table *table = &lots->table[lots->count];
    fg_context inner = {.message = ""};
    if (i && !strcmp(set->folder, lots->law->set[i - 1].folder)) continue;
    fg_status status = fg_lot_table_read(&inner, set->folder, &options, table);
    if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
    if (status != FG_OK) continue;
    if (!is_unchanged(table, set)) {
      fg_lot_table_free(table);
      continue;
    }
    lots->set[lots->count++] = i;
  }
  return FG_OK;
}

static const fg_column *column_of(const fg_table *table, const char *name) {
  for (size_t i = 0; i < table->columns; i++)
    if (!strcmp(table->column[i].name, name)) return &table->column[i];
  return NULL;
}

static double number_at(const fg_column *column, size_t row) {
  bool number = column && (!column->word || column->word[row] == FG_TABLE_NOT_A_WORD);
  return number ? column->number[row].value : NAN;
}

static const char *text_at(const fg_column *column, size_t row, char text[CELL_TEXT]) {
  text[0] = '\0';
  if (!column || (column->word && column->word[row] == FG_TABLE_MISSING)) return text;
  if (!column->word || column->word[row] == FG_TABLE_NOT_A_WORD)
    snprintf(text, CELL_TEXT, "%.12g", column->number[row].value);
  else
    fg_text_clip(text, CELL_TEXT, "%s", column->words[column->word[row]]);
  return text;
}

/* Columns of all lots, but for those that the table makes itself. */
static bool is_common_cause(const springback_lots *lots, const char *name) {
  static const char *const own[] = {"foil", "bump", "radius_mm"};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    if (!strcmp(name, own[i])) return false;
  for (size_t i = 0; i < lots->count; i++)
    if (!column_of(&lots->table[i].table, name)) return false;
  return true;
}

/* The set of a row: that of the die which its manifest names, or the lot's only one. */
static const fg_formed_data *data_of_row(const springback_lots *lots, size_t lot, size_t row) {
  char die[CELL_TEXT];
  const fg_formed_set *first = &lots->law->set[lots->set[lot]];
  text_at(column_of(&lots->table[lot].table, "die"), row, die);
  for (const fg_formed_set *set = first; set < lots->law->set + lots->law->sets; set++) {
    if (strcmp(set->folder, first->folder) != 0) break;
    if (!set->die[0] || !strcmp(set->die, die)) return &set->of[FG_FORMED_RADIUS];
  }
  return NULL;
}

static const fg_formed_place *place_of(const fg_formed_data *data, double number) {
  for (size_t i = 0; data && i < data->places; i++)
    if (data->place[i].number == (int)number) return &data->place[i];
  return NULL;
}

/* The law without single bumps: the set's mean, and what the die's radius there adds to it. */
static double predicted_pct(const springback_lots *lots, const fg_formed_data *data,
                            const fg_formed_place *place) {
  double ratio = 0, die = 0, count = (double)data->places;
  for (size_t i = 0; i < data->places; i++) {
    ratio += data->place[i].log_ratio / count;
    die += log(data->place[i].die) / count;
  }
  return 100 * (ratio + lots->exponent * (log(place->die) - die));
}

static void put_quoted(FILE *out, const char *text) {
  fputc('"', out);
  for (; *text; text++)
    fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
  fputs("\",", out);
}

static size_t put_lot_rows(FILE *out, const springback_lots *lots, size_t lot) {
  const fg_table *table = &lots->table[lot].table;
  const fg_column *bump = column_of(table, "bump"), *radius = column_of(table, "radius_mm");
  const fg_table *named = &lots->table[0].table;
  char cell[CELL_TEXT];
  size_t rows = 0;
  for (size_t row = 0; row < table->rows; row++) {
    const fg_formed_data *data = data_of_row(lots, lot, row);
    const fg_formed_place *place = place_of(data, number_at(bump, row));
    if (!place) continue;
    fprintf(out, "\"%zu: %.150s\",%d,", lot + 1, text_at(column_of(table, "foil"), row, cell),
            place->number);
    for (size_t i = 0; i < named->columns; i++)
      if (is_common_cause(lots, named->column[i].name))
        put_quoted(out, text_at(column_of(table, named->column[i].name), row, cell));
    fprintf(out, "%.12g,%.12g\n", predicted_pct(lots, data, place),
            100 * log(number_at(radius, row) / place->die));
    rows++;
  }
  return rows;
}

static fg_status make_springback_table(fg_context *ctx, const springback_lots *lots,
                                       fg_table *table, size_t *rows) {
  char *text = NULL;
  size_t size;
  const fg_table *named = &lots->table[0].table;
  FILE *out = fg_stream_open(&text, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the springback of all lots");
  fputs("foil,bump,", out);
  for (size_t i = 0; i < named->columns; i++)
    if (is_common_cause(lots, named->column[i].name)) put_quoted(out, named->column[i].name);
  fprintf(out, "%s,%s\n", declared, response);
  for (size_t i = 0; i < lots->count; i++)
    *rows += put_lot_rows(out, lots, i);
  if (!fg_stream_keep(out, &text))
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the springback of all lots");
  fg_status status =
      *rows < ROWS_MIN ? FG_OK : fg_table_parse(ctx, "the lots' springback", text, size, table);
  free(text);
  return status;
}

static fg_status run_springback_loop(fg_context *ctx, const fg_table *table,
                                     fg_expected_check *check) {
  const fg_loop_table_spec spec = {
      .response = response, .model = "1", .group = "foil", .offset = declared, .seed = 1};
  const fg_loop_options options = {.effects = fg_loop_table_effects(),
                                   .seed = 1,
                                   .minutes = LOOP_MINUTES,
                                   .mebibytes = LOOP_MEBIBYTES};
  fg_loop_table_problem problem = {.row = NULL};
  fg_loop_result result = {.claims = 0};
  char *sentence = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_loop_table_problem_build(ctx, table, &spec, &problem));
  FG_TRY_EXIT(fg_loop_run(ctx, &problem.problem, &options, &result));
  const fg_loop_report report = {.path = "the lots' springback",
                                 .sha256 = "",
                                 .spec = &spec,
                                 .problem = &problem,
                                 .result = &result,
                                 .seed = 1};
  FG_TRY_EXIT(fg_loop_sentence(ctx, &report, &sentence));
  fg_text_clip(check->loop_verdict, sizeof check->loop_verdict, "%s",
               fg_loop_outcome_word(result.verdict));
  fg_text_clip(check->loop_sentence, sizeof check->loop_sentence, "%s", sentence);
  if (result.claims)
    fg_text_clip(check->loop_name, sizeof check->loop_name, "%s", result.claim[0].name);
exit:
  free(sentence);
  fg_loop_result_free(&result);
  fg_loop_table_problem_free(&problem);
  return status;
}

fg_status fg_springback_loop(fg_context *ctx, fg_expected_check *check) {
  springback_lots lots = {.law = check->next.law,
                          .exponent = check->next.law->of[FG_FORMED_RADIUS].exponent};
  fg_table table = {.rows = 0};
  fg_context inner = {.message = ""};
  size_t rows = 0;
  fg_status status = FG_OK;
  if (!check->bumps) return FG_OK;
  FG_TRY_EXIT(read_lot_tables(ctx, &lots));
  if (lots.count) FG_TRY_EXIT(make_springback_table(ctx, &lots, &table, &rows));
  if (rows < ROWS_MIN) goto exit;
  /* A table that the loop refuses (too large, one foil alone) is no error of the lot. */
  if (run_springback_loop(&inner, &table, check) != FG_OK)
    fg_text_clip(check->loop_sentence, sizeof check->loop_sentence, "Not searched: %.400s",
                 inner.message);
exit:
  for (size_t i = 0; i < lots.count; i++)
    fg_lot_table_free(&lots.table[i]);
  fg_table_free(&table);
  return status;
}
