/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders: a barcode or a number opens one; progress, and its close. */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "page/page.h"
#include "station/news.h"
#include "station/pages.h"
#include "station/part_recipes.h"

enum { ORDERS_SHOWN = 30 };

static const struct {
  const char *label, *name, *list; /* SQL of known values; NULL: none */
} order_fields[] = {
    {"Part", "part", NULL},
    {"Lot", "lot", NULL},
    {"Die", "die",
     "SELECT die FROM foils WHERE die <> '' GROUP BY die ORDER BY max(id) DESC LIMIT 50"},
    {"Coil", "coil",
     "SELECT coil FROM foils WHERE coil <> '' GROUP BY coil ORDER BY max(id) DESC LIMIT 50"},
    {"Operator", "operator",
     "SELECT operator FROM foils WHERE operator <> '' GROUP BY operator ORDER BY max(id) DESC "
     "LIMIT "
     "50"},
};
enum { ORDER_FIELDS = sizeof order_fields / sizeof *order_fields };

static fg_status write_known_values(fg_context *ctx, sqlite3 *reader, size_t i, FILE *out) {
  fg_query query;
  if (!order_fields[i].list) return FG_OK;
  fprintf(out, "<datalist id=\"known-%s\">", order_fields[i].name);
  fg_query_begin(reader, order_fields[i].list, &query);
  while (fg_query_row(&query)) {
    fputs("<option value=\"", out);
    fg_html_text(out, fg_query_get_text(&query, 0));
    fputs("\">", out);
  }
  fputs("</datalist>", out);
  return fg_query_end(ctx, &query, "reading the names");
}

/* A barcode reader types the number and Enter: the other fields may stay empty where a file of
 * --orders knows them. */
static fg_status write_opening(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                               const char *unknown, FILE *out) {
  fputs("<form class=\"fields\" method=\"post\" action=\"/order\">", out);
  fg_page_csrf_token(station, out);
  fputs(
      "<label>Order (barcode)<input name=\"number\" maxlength=\"127\" autocomplete=\"off\" required"
      " data-focus value=\"",
      out);
  fg_html_text(out, unknown);
  fputs("\"></label>", out);
  for (size_t i = 0; i < ORDER_FIELDS; i++) {
    fprintf(out, "<label>%s<input name=\"%s\" maxlength=\"127\" autocomplete=\"off\"",
            order_fields[i].label, order_fields[i].name);
    if (order_fields[i].list) fprintf(out, " list=\"known-%s\"", order_fields[i].name);
    fputs("></label>", out);
    FG_TRY(write_known_values(ctx, reader, i, out));
  }
  fputs("<label>Pieces<input name=\"pieces\" type=\"number\" min=\"0\" max=\"1000000\"></label>"
        "<button>Open the order</button></form>\n",
        out);
  return FG_OK;
}

static void write_open_order(const fg_inspection *station, const fg_order *order, FILE *out) {
  const char *const values[] = {order->part, order->lot, order->die, order->coil,
                                order->operator_name};
  fputs("<h2 class=\"first\">Open: ", out);
  fg_html_name(out, order->number);
  fputs("</h2>\n<p class=\"next\">", out);
  fprintf(out, "<b>%lld", (long long)order->measured);
  if (order->pieces) fprintf(out, " of %lld", (long long)order->pieces);
  fprintf(out, "</b>, %lld failed. Scans that come now belong to it.", (long long)order->failed);
  for (size_t i = 0; i < ORDER_FIELDS; i++) {
    if (!values[i][0]) continue;
    fprintf(out, " %s ", order_fields[i].label);
    fg_html_name(out, values[i]);
    fputc('.', out);
  }
  if (station->settings->part_count) {
    fputs(" Design ", out);
    fg_html_name(out, fg_part_recipe_of(station, order).lot->design.name);
    fputc('.', out);
  }
  fputs("</p>\n<form class=\"fields\" method=\"post\" action=\"/order-close\">", out);
  fg_page_csrf_token(station, out);
  fprintf(
      out,
      "<input type=\"hidden\" name=\"order\" value=\"%lld\"><label>Closed by<input name=\"by\" "
      "maxlength=\"127\" autocomplete=\"off\" required></label><button class=\"plain\">Close the "
      "order</button></form>\n",
      (long long)order->id);
}

static void write_order_line(const fg_query *query, FILE *out) {
  fputs("<li><b>", out);
  fg_html_name(out, fg_query_get_text(query, 0));
  fputs("</b>", out);
  if (fg_query_get_text(query, 2)[0])
    fg_html_name((fputs(", lot ", out), out), fg_query_get_text(query, 2));
  if (fg_query_get_text(query, 1)[0])
    fg_html_name((fputs(", part ", out), out), fg_query_get_text(query, 1));
  fprintf(out, ": %lld", (long long)fg_query_get_integer(query, 7));
  if (fg_query_get_integer(query, 3))
    fprintf(out, " of %lld", (long long)fg_query_get_integer(query, 3));
  fputs(" measured; opened ", out);
  fg_page_time(out, fg_query_get_integer(query, 4));
  if (fg_query_get_integer(query, 5)) {
    fputs(", closed ", out);
    fg_page_time(out, fg_query_get_integer(query, 5));
    fg_html_name((fputs(" by ", out), out), fg_query_get_text(query, 6));
  }
  fputs("</li>\n", out);
}

static fg_status list_orders(fg_context *ctx, sqlite3 *reader, FILE *out) {
  fg_query query;
  size_t count = 0;
  fg_query_begin(reader,
                 "SELECT number, part, lot, pieces, opened_at, closed_at, closed_by, (SELECT"
                 " count(DISTINCT serial) FROM foils WHERE order_id = orders.id) FROM orders ORDER"
                 " BY opened_at DESC, id DESC LIMIT ?",
                 &query);
  fg_query_integer(&query, ORDERS_SHOWN);
  for (; fg_query_row(&query); count++) {
    if (!count) fputs("<h2>Newest orders</h2>\n<ul class=\"causes\">", out);
    write_order_line(&query, out);
  }
  if (count) fputs("</ul>\n", out);
  return fg_query_end(ctx, &query, "reading the orders");
}

fg_status fg_page_orders(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                         const fg_request *request, FILE *out) {
  fg_order order;
  const char *unknown = fg_request_get(request, "unknown");
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_ORDERS, "Orders"));
  fputs("<section>\n<h1>Orders</h1>\n", out);
  FG_TRY(fg_order_read_open(ctx, reader, &order));
  if (order.id) write_open_order(station, &order, out);
  if (unknown[0]) {
    fputs("<p class=\"next\" role=\"alert\">Nobody knows the order <b>", out);
    fg_html_name(out, unknown);
    fputs("</b>: fill in its lot to open it by hand.</p>\n", out);
  }
  FG_TRY(write_opening(ctx, station, reader, unknown, out));
  FG_TRY(list_orders(ctx, reader, out));
  fputs("</section>\n", out);
  fg_page_end(out);
  return FG_OK;
}

/* ---- actions ---- */

static fg_status read_field(fg_context *ctx, const char *what, const char *given,
                            char field[FG_NAMED_TEXT]) {
  char text[FG_NAMED_TEXT];
  FG_TRY(fg_request_read_text(ctx, what, given, text, sizeof text));
  if (text[0]) strcpy(field, text);
  return FG_OK;
}

/* Fields of the html form win over those of a file. */
static fg_status read_fields(fg_context *ctx, const fg_request *request, fg_order *order) {
  char *const fields[] = {order->part, order->lot, order->die, order->coil, order->operator_name};
  for (size_t i = 0; i < ORDER_FIELDS; i++)
    FG_TRY(read_field(ctx, order_fields[i].name, fg_request_get(request, order_fields[i].name),
                      fields[i]));
  const char *pieces = fg_request_get(request, "pieces");
  if (pieces[0]) order->pieces = strtoll(pieces, NULL, 10);
  return FG_OK;
}

/* The order opened last is in force. Where the clock was set back, that is not the latest time: an
 * open order's time comes before it. */
static fg_status keep_order(fg_context *ctx, sqlite3 *writer, const fg_order *order) {
  fg_query query;
  fg_query_begin(writer,
                 "INSERT INTO orders (number, part, lot, die, coil, operator, pieces, opened_at)"
                 " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, max(?8, (SELECT coalesce(max(opened_at), 0)"
                 " + 1 FROM orders WHERE closed_at = 0 AND number <> ?1))) ON CONFLICT (number) DO"
                 " UPDATE SET part = excluded.part, lot = excluded.lot, die = excluded.die, coil ="
                 " excluded.coil, operator = excluded.operator, pieces = excluded.pieces, opened_at"
                 " = excluded.opened_at, closed_at = 0, closed_by = ''",
                 &query);
  fg_query_text(&query, order->number);
  fg_query_text(&query, order->part);
  fg_query_text(&query, order->lot);
  fg_query_text(&query, order->die);
  fg_query_text(&query, order->coil);
  fg_query_text(&query, order->operator_name);
  fg_query_integer(&query, order->pieces > 0 ? order->pieces : 0);
  fg_query_integer(&query, fg_station_now());
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "opening an order");
}

/* Address of the page that asks for the fields of an unknown order. */
static void ask_for_fields(const char *number, fg_answer *answer) {
  size_t length = strlen(strcpy(answer->location, "/orders?unknown="));
  for (const char *at = number; *at && length + 4 < sizeof answer->location; at++)
    length += (size_t)snprintf(answer->location + length, 4, "%%%02X", (unsigned char)*at);
}

static fg_status find_known_order(fg_context *ctx, fg_inspection *station, const char *number,
                                  fg_order *order) {
  fg_station_database *database = &station->database;
  pthread_mutex_lock(&database->reading);
  fg_status status = fg_order_find(ctx, database->reader, station->request, number, order);
  pthread_mutex_unlock(&database->reading);
  return status;
}

fg_status fg_action_order(fg_context *ctx, fg_inspection *station, const fg_request *request,
                          fg_answer *answer) {
  fg_order order;
  char number[FG_NAMED_TEXT - FG_ORDER_SCAN_BYTES];
  FG_TRY(
      fg_request_read_text(ctx, "order", fg_request_get(request, "number"), number, sizeof number));
  if (!number[0]) return fg_fail(ctx, FG_ERR_DATA, "The order has no number.");
  FG_TRY(find_known_order(ctx, station, number, &order));
  bool known = order.number[0] != '\0';
  FG_TRY(read_fields(ctx, request, &order));
  if (!known && !order.lot[0]) {
    ask_for_fields(number, answer);
    return FG_OK;
  }
  if (!known) strcpy(order.number, number);
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 keep_order(ctx, station->database.writer, &order)));
  fg_station_notify(station);
  strcpy(answer->location, "/");
  return FG_OK;
}

fg_status fg_action_order_close(fg_context *ctx, fg_inspection *station, const fg_request *request,
                                fg_answer *answer) {
  fg_query query;
  const char *by = fg_request_get(request, "by");
  if (!by[strspn(by, " ")])
    return fg_fail(ctx, FG_ERR_DATA, "Who closes the order? Go back and fill in the name.");
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  fg_query_begin(station->database.writer,
                 "UPDATE orders SET closed_at = ?, closed_by = ? WHERE id = ? AND closed_at = 0",
                 &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, by);
  fg_query_integer(&query, strtoll(fg_request_get(request, "order"), NULL, 10));
  fg_query_row(&query);
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 fg_query_end(ctx, &query, "closing an order")));
  fg_station_notify(station);
  strcpy(answer->location, "/orders");
  return FG_OK;
}
