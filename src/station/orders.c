/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/orders.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "core/text.h"
#include "foilgauge/table.h"
#include "page/page.h"

/* Columns of an ERP's file, and of the html form. */
static const struct {
  const char *name, *other;
  size_t offset;
} columns[] = {
    {"order", "number", offsetof(fg_order, number)},
    {"part", "article", offsetof(fg_order, part)},
    {"lot", "batch", offsetof(fg_order, lot)},
    {"die", "tool", offsetof(fg_order, die)},
    {"coil", "material", offsetof(fg_order, coil)},
    {"operator", "operator", offsetof(fg_order, operator_name)},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

#define FIELDS "id, number, part, lot, die, coil, operator, pieces, opened_at"

static void read_order_row(const fg_query *query, fg_order *order) {
  order->id = fg_query_get_integer(query, 0);
  for (size_t i = 0; i < COLUMNS; i++)
    fg_text_clip((char *)order + columns[i].offset, FG_NAMED_TEXT, "%s",
                 fg_query_get_text(query, (int)i + 1));
  order->pieces = fg_query_get_integer(query, 7);
  order->opened_at = fg_query_get_integer(query, 8);
}

/* Of a serial number that was measured again its newest foil counts. */
static fg_status count_order_foils(fg_context *ctx, sqlite3 *connection, fg_order *order) {
  fg_query query;
  fg_query_begin(connection,
                 "SELECT count(*), coalesce(sum(verdict = 'fail'), 0) FROM foils WHERE id IN"
                 " (SELECT max(id) FROM foils WHERE order_id = ? GROUP BY serial)",
                 &query);
  fg_query_integer(&query, order->id);
  if (fg_query_row(&query)) {
    order->measured = fg_query_get_integer(&query, 0);
    order->failed = fg_query_get_integer(&query, 1);
  }
  return fg_query_end(ctx, &query, "counting the foils of an order");
}

fg_status fg_order_read_open(fg_context *ctx, sqlite3 *connection, fg_order *order) {
  fg_query query;
  *order = (fg_order){0};
  fg_query_begin(connection,
                 "SELECT " FIELDS " FROM orders WHERE opened_at > 0 AND closed_at = 0 ORDER BY"
                 " opened_at DESC, id DESC LIMIT 1",
                 &query);
  if (fg_query_row(&query)) read_order_row(&query, order);
  FG_TRY(fg_query_end(ctx, &query, "reading the orders"));
  return order->id ? count_order_foils(ctx, connection, order) : FG_OK;
}

/* ---- files of an ERP ---- */

/* Returns a cell, whole; "" where it is missing. */
static const char *get_order_cell(const fg_column *column, size_t row) {
  bool missing = !column->word || column->word[row] == FG_TABLE_MISSING;
  return missing ? "" : column->words[column->word[row]];
}

static const fg_column *find_order_column(const fg_table *table, const char *name,
                                          const char *other) {
  for (size_t c = 0; c < table->columns; c++)
    if (!strcasecmp(table->column[c].name, name) || !strcasecmp(table->column[c].name, other))
      return &table->column[c];
  return NULL;
}

static const char *without_zeros(const char *number) {
  bool digits = number[strspn(number, "0123456789")] == '\0';
  return digits ? number + strspn(number, "0") : number;
}

/* Returns the last row of the number, as ERPs append; where none is written like it, one that
 * differs in leading zeros. table->rows: there is none. */
static size_t find_order_row(const fg_table *table, const char *number) {
  const fg_column *numbers = find_order_column(table, columns[0].name, columns[0].other);
  size_t found = table->rows;
  for (size_t row = table->rows; numbers && row-- > 0;) {
    const char *text = get_order_cell(numbers, row);
    if (!strcmp(text, number)) return row;
    if (found == table->rows && text[0] && !strcmp(without_zeros(text), without_zeros(number)))
      found = row;
  }
  return found;
}

static void read_order_cells(const fg_table *table, size_t row, fg_order *order) {
  const fg_column *pieces = find_order_column(table, "pieces", "quantity");
  *order = (fg_order){0};
  for (size_t i = 0; i < COLUMNS; i++) {
    const fg_column *column = find_order_column(table, columns[i].name, columns[i].other);
    const char *text = column ? get_order_cell(column, row) : "";
    fg_named_keep((char *)order + columns[i].offset, text, strlen(text));
  }
  if (pieces) order->pieces = strtoll(get_order_cell(pieces, row), NULL, 10);
}

static fg_status find_in_order_file(fg_context *ctx, const char *path, const char *number,
                                    fg_order *order) {
  fg_table table = {0};
  char sum[65];
  FG_TRY(fg_table_load_words(ctx, path, &table, sum));
  size_t row = find_order_row(&table, number);
  if (row < table.rows) read_order_cells(&table, row, order);
  fg_table_free(&table);
  return FG_OK;
}

/* True for the file of two that an ERP wrote last. */
static bool is_later(const struct stat *file, const struct stat *other) {
  return file->st_mtim.tv_sec != other->st_mtim.tv_sec
             ? file->st_mtim.tv_sec > other->st_mtim.tv_sec
             : file->st_mtim.tv_nsec > other->st_mtim.tv_nsec;
}

/* Of every *.csv of the folder that has the number, the one that was written last counts. */
static fg_status find_in_folder(fg_context *ctx, const char *path, const char *number,
                                fg_order *order) {
  DIR *folder = opendir(path);
  fg_status status = FG_OK;
  struct stat newest = {0}, about;
  if (!folder)
    return fg_fail(ctx, FG_ERR_IO, "%s: the folder of orders cannot be read: %s", path,
                   strerror(errno));
  for (struct dirent *entry; status == FG_OK && (entry = readdir(folder));) {
    size_t length = strlen(entry->d_name);
    char *file = NULL;
    if (length < 5 || entry->d_name[0] == '.' ||
        strcasecmp(entry->d_name + length - 4, ".csv") != 0 ||
        fstatat(dirfd(folder), entry->d_name, &about, 0) != 0)
      continue;
    if (order->number[0] && !is_later(&about, &newest)) continue;
    fg_order found = {0};
    status = fg_text_print(ctx, &file, "%s/%s", path, entry->d_name);
    if (status == FG_OK) status = find_in_order_file(ctx, file, number, &found);
    free(file);
    if (status != FG_OK || !found.number[0]) continue;
    *order = found;
    newest = about;
  }
  closedir(folder);
  return status;
}

/* Fills in the order as the ERP has it now; number "": it has none. */
static fg_status find_in_orders(fg_context *ctx, const char *path, const char *number,
                                fg_order *order) {
  struct stat about;
  *order = (fg_order){0};
  if (stat(path, &about) == 0 && S_ISDIR(about.st_mode))
    return find_in_folder(ctx, path, number, order);
  return find_in_order_file(ctx, path, number, order);
}

/* Fields that the ERP leaves empty stay. */
static void update_fields(fg_order *order, const fg_order *now) {
  for (size_t i = 1; i < COLUMNS; i++) {
    const char *text = (const char *)now + columns[i].offset;
    if (text[0]) fg_text_clip((char *)order + columns[i].offset, FG_NAMED_TEXT, "%s", text);
  }
  if (now->pieces) order->pieces = now->pieces;
}

fg_status fg_order_find(fg_context *ctx, sqlite3 *connection, const fg_station_request *request,
                        const char *number, fg_order *order) {
  fg_query query;
  fg_order now;
  fg_context inner;
  bool is_open = false;
  *order = (fg_order){0};
  fg_query_begin(connection, "SELECT " FIELDS ", closed_at = 0 FROM orders WHERE number = ?",
                 &query);
  fg_query_text(&query, number);
  if (fg_query_row(&query)) {
    read_order_row(&query, order);
    is_open = fg_query_get_integer(&query, 9) != 0;
  }
  FG_TRY(fg_query_end(ctx, &query, "reading the orders"));
  if (is_open || !request->orders) return FG_OK;
  if (!order->id) return find_in_orders(ctx, request->orders, number, order);
  /* A known order opens where the files cannot be read. */
  if (find_in_orders(&inner, request->orders, number, &now) == FG_OK && now.number[0])
    update_fields(order, &now);
  return FG_OK;
}

/* ---- scans ---- */

static void fill_field(char field[FG_NAMED_TEXT], const char *value) {
  if (!field[0]) fg_text_clip(field, FG_NAMED_TEXT, "%s", value);
}

static fg_status count_scans(fg_context *ctx, sqlite3 *connection, int64_t id, int64_t *count) {
  fg_query query;
  fg_query_begin(connection, "SELECT count(DISTINCT scan) FROM foils WHERE order_id = ?", &query);
  fg_query_integer(&query, id);
  *count = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "counting the scans of an order");
}

fg_status fg_order_of_scan(fg_context *ctx, fg_inspection *station, fg_order *order) {
  fg_station_database *database = &station->database;
  pthread_mutex_lock(&database->writing);
  fg_status status = fg_order_read_open(ctx, database->writer, order);
  pthread_mutex_unlock(&database->writing);
  return status;
}

fg_status fg_order_apply(fg_context *ctx, fg_inspection *station, const fg_order *order,
                         bool by_button, fg_named *named) {
  fg_station_database *database = &station->database;
  int64_t count;
  if (!order->id) return FG_OK;
  fill_field(named->lot, order->lot);
  fill_field(named->die, order->die);
  fill_field(named->coil, order->coil);
  fill_field(named->operator_name, order->operator_name);
  if (!by_button) return FG_OK;
  pthread_mutex_lock(&database->writing);
  fg_status status = count_scans(ctx, database->writer, order->id, &count);
  pthread_mutex_unlock(&database->writing);
  FG_TRY(status);
  fg_text_clip(named->serial, FG_NAMED_TEXT, "%.*s-%03lld", FG_NAMED_TEXT - FG_ORDER_SCAN_BYTES,
               order->number, (long long)count + 1);
  return FG_OK;
}

void fg_order_file_part(const fg_order *order, char *text, size_t size) {
  size_t length = 0;
  for (const char *at = order->number; *at && length + 1 < size; at++) {
    bool plain = (*at >= '0' && *at <= '9') || (*at >= 'a' && *at <= 'z') ||
                 (*at >= 'A' && *at <= 'Z') || *at == '-' || *at == '_';
    if (plain) text[length++] = *at;
  }
  text[length] = '\0';
}

fg_status fg_order_write_progress(fg_context *ctx, sqlite3 *reader, FILE *out) {
  fg_order order;
  FG_TRY(fg_order_read_open(ctx, reader, &order));
  if (!order.id) return FG_OK;
  fputs("<p class=\"order\"><a href=\"/orders\">Order ", out);
  fg_html_name(out, order.number);
  fprintf(out, "</a>: <b>%lld", (long long)order.measured);
  if (order.pieces) fprintf(out, " of %lld", (long long)order.pieces);
  fprintf(out, "</b>, %lld failed", (long long)order.failed);
  if (order.pieces && order.measured >= order.pieces)
    fputs(" — all pieces are measured: <a href=\"/orders\">close the order</a>", out);
  fputs("</p>\n", out);
  return FG_OK;
}
