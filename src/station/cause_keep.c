/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/cause_keep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "page/page.h"

enum { CAUSES_MAX = 26 }; /* a chart names them by letters */

static const char *owner_word(const fg_trend_choice *choice) {
  return choice->owner == FG_QUANTITY_OF_BUMP ? "bump" : "foil";
}

static void bind_quantity(fg_query *query, const fg_trend_choice *choice) {
  fg_query_text(query, owner_word(choice));
  fg_query_text(query, choice->row->name);
  fg_query_integer(query, choice->bump);
}

static fg_status read_points(fg_context *ctx, sqlite3 *reader, int64_t id, fg_cause *cause) {
  fg_query query;
  size_t room = 0;
  fg_status status = FG_OK;
  fg_query_begin(reader, "SELECT level, x, shift FROM cause_points WHERE cause = ? ORDER BY number",
                 &query);
  fg_query_integer(&query, id);
  while (status == FG_OK && fg_query_row(&query)) {
    status = fg_memory_reserve(ctx, cause->points + 1, sizeof *cause->point, &room,
                               (void **)&cause->point);
    if (status != FG_OK) break;
    fg_cause_point *point = &cause->point[cause->points++];
    *point = (fg_cause_point){.x = fg_query_get_number(&query, 1),
                              .shift = fg_query_get_number(&query, 2)};
    fg_text_clip(point->level, sizeof point->level, "%s", fg_query_get_text(&query, 0));
    cause->words = isnan(point->x);
  }
  fg_status ended = fg_query_end(ctx, &query, "reading a cause");
  return status == FG_OK ? ended : status;
}

static fg_status read_causes(fg_context *ctx, sqlite3 *reader, fg_query *query, fg_cause **causes,
                             size_t *count) {
  fg_status status = FG_OK;
  size_t room = 0;
  while (status == FG_OK && *count < CAUSES_MAX && fg_query_row(query)) {
    status = fg_memory_reserve(ctx, *count + 1, sizeof **causes, &room, (void **)causes);
    if (status != FG_OK) break;
    fg_cause *cause = &(*causes)[(*count)++];
    *cause = (fg_cause){.value = fg_query_get_number(query, 3),
                        .u = fg_query_get_number(query, 4),
                        .since = fg_query_get_integer(query, 5)};
    fg_text_clip(cause->name, sizeof cause->name, "%s", fg_query_get_text(query, 1));
    fg_text_clip(cause->words_of, sizeof cause->words_of, "%s", fg_query_get_text(query, 2));
    status = read_points(ctx, reader, fg_query_get_integer(query, 0), cause);
  }
  return status;
}

fg_status fg_causes_read(fg_context *ctx, sqlite3 *reader, const fg_trend_choice *choice,
                         fg_cause **causes, size_t *count) {
  fg_query query;
  *causes = NULL;
  *count = 0;
  fg_query_begin(reader,
                 "SELECT id, name, words, value, u, since FROM causes WHERE owner = ? AND quantity"
                 " = ? AND bump = ? AND withdrawn_at = 0 ORDER BY id",
                 &query);
  bind_quantity(&query, choice);
  fg_status status = read_causes(ctx, reader, &query, causes, count);
  fg_status ended = fg_query_end(ctx, &query, "reading the causes");
  if (status == FG_OK) status = ended;
  if (status == FG_OK) return FG_OK;
  fg_causes_free(*causes, *count);
  *causes = NULL;
  *count = 0;
  return status;
}

void fg_causes_free(fg_cause *causes, size_t count) {
  for (size_t k = 0; k < count; k++)
    free(causes[k].point);
  free(causes);
}

static fg_status insert_points(fg_context *ctx, sqlite3 *writer, const fg_cause *cause,
                               int64_t id) {
  fg_query query;
  fg_query_begin(writer,
                 "INSERT INTO cause_points (cause, number, level, x, shift) VALUES (?, ?, ?, ?, ?)",
                 &query);
  for (size_t k = 0; k < cause->points; k++) {
    fg_query_integer(&query, id);
    fg_query_integer(&query, (int64_t)k);
    fg_query_text(&query, cause->point[k].level);
    fg_query_number(&query, cause->words ? NAN : cause->point[k].x);
    fg_query_number(&query, cause->point[k].shift);
    fg_query_row(&query);
    fg_query_again(&query);
  }
  return fg_query_end(ctx, &query, "keeping a cause");
}

static fg_status insert_cause(fg_context *ctx, sqlite3 *writer, const fg_trend_choice *choice,
                              const fg_cause *cause, const char *by, const char *note) {
  fg_query query;
  fg_query_begin(writer,
                 "INSERT INTO causes (owner, quantity, bump, name, words, value, u, since, by, at,"
                 " note) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                 &query);
  bind_quantity(&query, choice);
  fg_query_text(&query, cause->name);
  fg_query_text(&query, cause->words_of);
  fg_query_number(&query, cause->value);
  fg_query_number(&query, cause->u);
  fg_query_integer(&query, cause->since);
  fg_query_text(&query, by);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, note);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a cause"));
  return insert_points(ctx, writer, cause, fg_sqlite.last_insert_rowid(writer));
}

fg_status fg_cause_keep(fg_context *ctx, fg_station_database *database,
                        const fg_trend_choice *choice, const fg_cause *cause, const char *by,
                        const char *note) {
  FG_TRY(fg_station_database_begin(ctx, database));
  return fg_station_database_end(ctx, database,
                                 insert_cause(ctx, database->writer, choice, cause, by, note));
}

/* ---- on charts ---- */

static void add_shifts(const fg_cause_data *data, const fg_cause *cause,
                       const fg_shifted_points *points, double *shift) {
  const fg_cause_column *column = fg_cause_column_find(data, cause->name);
  for (size_t i = 0, k = 0; i < points->count && k < data->foils; i++) {
    while (k < data->foils && data->foil[k] < points->foil[i])
      k++;
    if (k < data->foils && data->foil[k] == points->foil[i])
      shift[i] += fg_cause_shift(cause, column, k);
  }
}

static fg_status shift_points(fg_context *ctx, const fg_station_request *request, sqlite3 *reader,
                              const fg_shifted_points *points, double *shift) {
  fg_station_contexts contexts;
  fg_cause_data data;
  FG_TRY(fg_station_contexts_load(ctx, request, &contexts));
  fg_status status =
      fg_cause_data_of_foils(ctx, reader, &contexts, points->foil, points->count, &data);
  for (size_t list = 0; status == FG_OK && list < 2; list++)
    for (size_t k = 0; k < points->causes[list]; k++)
      add_shifts(&data, &points->cause[list][k], points, shift);
  if (status == FG_OK) fg_cause_data_free(&data);
  fg_station_contexts_free(&contexts);
  return status;
}

fg_status fg_causes_find_shifts(fg_context *ctx, const fg_station_request *request, sqlite3 *reader,
                                const fg_shifted_points *points, double **shift) {
  *shift = NULL;
  if (!points->causes[0] && !points->causes[1]) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, points->count, sizeof **shift, (void **)shift));
  fg_status status = shift_points(ctx, request, reader, points, *shift);
  if (status == FG_OK) return FG_OK;
  free(*shift);
  *shift = NULL;
  return status;
}

static void write_withdrawal(const fg_inspection *station, const fg_trend_choice *choice,
                             int64_t id, FILE *out) {
  fputs("<form class=\"fields\" method=\"post\" action=\"/withdraw\">", out);
  fg_page_csrf_token(station, out);
  fg_trend_write_hidden(out, choice);
  fprintf(out,
          "<input type=\"hidden\" name=\"cause\" value=\"%lld\"><label>Withdrawn by<input "
          "name=\"by\" maxlength=\"127\" autocomplete=\"off\" required></label><button "
          "class=\"plain\">Withdraw</button></form>",
          (long long)id);
}

static void write_accepted(const fg_inspection *station, const fg_trend_choice *choice,
                           const fg_query *query, char letter, FILE *out) {
  bool withdrawn = fg_query_get_integer(query, 6) != 0;
  fputs("<li>", out);
  if (!withdrawn) fprintf(out, "<b translate=\"no\">%c</b> ", letter);
  fg_html_text(out, fg_query_get_text(query, 1));
  fprintf(out, ": %+.4g, U %.2g", fg_query_get_number(query, 2), 2 * fg_query_get_number(query, 3));
  fg_html_text((fputc(' ', out), out), choice->row->unit);
  fputs("; accepted by ", out);
  fg_html_name(out, fg_query_get_text(query, 4));
  fputs(", ", out);
  fg_page_time_zoned(out, fg_query_get_integer(query, 5));
  if (fg_query_get_text(query, 8)[0])
    fg_html_name((fputs(": ", out), out), fg_query_get_text(query, 8));
  if (withdrawn) {
    fputs("; withdrawn by ", out);
    fg_html_name(out, fg_query_get_text(query, 7));
    fputs(", ", out);
    fg_page_time_zoned(out, fg_query_get_integer(query, 6));
  } else {
    write_withdrawal(station, choice, fg_query_get_integer(query, 0), out);
  }
  fputs("</li>\n", out);
}

fg_status fg_page_causes(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                         const fg_trend_choice *choice, FILE *out) {
  fg_query query;
  size_t count = 0, in_force = 0;
  fg_query_begin(reader,
                 "SELECT id, words, value, u, by, at, withdrawn_at, withdrawn_by, note FROM causes"
                 " WHERE owner = ? AND quantity = ? AND bump = ? ORDER BY withdrawn_at <> 0, id",
                 &query);
  bind_quantity(&query, choice);
  for (; fg_query_row(&query); count++) {
    if (!count) fputs("<h2>Accepted causes</h2>\n<ul class=\"causes\">", out);
    bool withdrawn = fg_query_get_integer(&query, 6) != 0;
    write_accepted(station, choice, &query, (char)('a' + in_force % CAUSES_MAX), out);
    in_force += !withdrawn;
  }
  if (count) fputs("</ul>\n", out);
  if (in_force)
    fputs("<p class=\"note\">The chart's limits are taken about these causes; no value is "
          "changed.</p>\n",
          out);
  return fg_query_end(ctx, &query, "reading the causes");
}
