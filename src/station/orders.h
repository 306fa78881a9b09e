/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders: the scans that come belong to the one that is open. */
#ifndef FG_STATION_ORDERS_H
#define FG_STATION_ORDERS_H

#include "station/naming.h"
#include "station/state.h"

/* FG_ORDER_SCAN_BYTES: of "-001", what a scan's serial number has behind its order's. */
enum { FG_ORDER_SCAN_BYTES = 8 };

typedef struct fg_order {
  int64_t id; /* 0: none */
  char number[FG_NAMED_TEXT], part[FG_NAMED_TEXT], lot[FG_NAMED_TEXT], die[FG_NAMED_TEXT],
      coil[FG_NAMED_TEXT], operator_name[FG_NAMED_TEXT];
  int64_t pieces;           /* 0: not given */
  int64_t measured, failed; /* serial numbers: of the newest measurement of each */
  int64_t opened_at;
} fg_order;

/* Reads the open order with its progress; id 0: none is open. */
fg_status fg_order_read_open(fg_context *ctx, sqlite3 *connection, fg_order *order);

/* Looks an order up by its number in the database and in the files of --orders: of a closed order
 * what the files say now wins, an open one keeps its fields. id is 0 and number "" when nobody
 * knows it; id alone is 0 when only a file does. */
fg_status fg_order_find(fg_context *ctx, sqlite3 *connection, const fg_station_request *request,
                        const char *number, fg_order *order);

/* Reads the order that is open as a scan comes: all of the scan belongs to it. */
fg_status fg_order_of_scan(fg_context *ctx, fg_inspection *station, fg_order *order);
/* Fills the fields that a file's name leaves empty by the order; a scan of the Scan button gets the
 * next serial number of it. */
fg_status fg_order_apply(fg_context *ctx, fg_inspection *station, const fg_order *order,
                         bool by_button, fg_named *named);

/* Number as a part of a file's name: letters, digits, `-` and `_` of it. */
void fg_order_file_part(const fg_order *order, char *text, size_t size);

/* Writes "Order 4711: 17 of 40, 2 failed" with a link; nothing without an open order. */
fg_status fg_order_write_progress(fg_context *ctx, sqlite3 *reader, FILE *out);

#endif
