/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages and actions of a station, and their common parts. */
#ifndef FG_STATION_PAGES_H
#define FG_STATION_PAGES_H

#include "station/request.h"

typedef enum fg_tab {
  FG_TAB_NOW,
  FG_TAB_HISTORY,
  FG_TAB_TRENDS,
  FG_TAB_SCANNER,
  FG_TAB_LOTS,
  FG_TAB_ORDERS
} fg_tab;

fg_page_writer fg_page_now, fg_page_history, fg_page_trends, fg_page_scanner, fg_page_lots,
    fg_page_orders;
fg_page_writer fg_page_why;     /* causes of a trend: a search, its answer */
fg_page_writer fg_page_foil;    /* one foil: its values, its trail, its form */
fg_page_writer fg_page_picture; /* its picture, drawn anew from the scan */
fg_page_writer fg_page_report;  /* its whole report, measured again from the scan */
fg_page_writer fg_page_found;   /* all foils of a search as CSV, DFQ or QIF */
fg_page_writer fg_page_lot;     /* the report of a closed lot, from its folder */

/* Writes a page from its doctype to <main>, with the tabs and, where it is due, the scanner's
 * banner. */
fg_status fg_page_begin(fg_context *ctx, fg_inspection *station, sqlite3 *reader, FILE *out,
                        fg_tab tab, const char *title);
void fg_page_end(FILE *out);
/* Writes the heading of a page that shows none: screen readers find it by that. */
void fg_page_heading(FILE *out, const char *words);

/* Writes "2026-03-01 14:02:33", local time. */
void fg_page_time(FILE *out, int64_t at);
/* Writes it with its offset from UTC: "2026-03-01 14:02:33 +01:00". */
void fg_page_time_zoned(FILE *out, int64_t at);

/* Writes "name=value&amp;" encoded for an address. */
void fg_page_parameter(FILE *out, const char *name, const char *value);

/* Writes the hidden field of every html form, which protects it from other sites (CSRF). */
void fg_page_csrf_token(const fg_inspection *station, FILE *out);

/* Return PASS, FAIL, SCAN AGAIN, MEASURED; and the CSS class for it. */
const char *fg_page_verdict_words(const char *verdict, bool withheld);
const char *fg_page_verdict_class(const char *verdict, bool withheld);

/* True of a check's words when the scanner is in order. */
bool fg_page_check_passed(const char *words);

/* Both of a card in the list of arrivals: its kind and words, and the verdict of its scan where it
 * has one. A scan that was measured before gives no verdict again. */
typedef struct fg_card_style {
  const char *words, *style;
} fg_card_style;
fg_card_style fg_page_card_style(const char *kind, const char *words, const char *verdict,
                                 bool withheld);

/* Returns the styles of the reports and the station's own. */
const char *fg_station_style_text(void);
extern const char fg_station_style[];      /* station.css */
extern const char fg_station_dark_style[]; /* dark.css */
extern const char fg_station_script[];     /* station.js */
extern const char fg_station_icon[];       /* SVG */

/* An action of an html form: the answer redirects the browser, or carries a file. */
typedef fg_status fg_action(fg_context *ctx, fg_inspection *station, const fg_request *request,
                            fg_answer *answer);

fg_action fg_action_correct;  /* serial, lot, die, operator of a foil; leaves a trail */
fg_action fg_action_scan;     /* runs the recipe's scan_command */
fg_action fg_action_baseline; /* makes the newest check the baseline of later ones */
fg_action fg_action_close;    /* a lot: writes its folder and report */
fg_action fg_action_dispose;  /* says the fate of a foil that did not pass */
fg_action fg_action_order;    /* opens an order */
fg_action fg_action_order_close;
fg_action fg_action_why;      /* searches for causes of a trend */
fg_action fg_action_accept;   /* a cause: limits are taken about it from then on */
fg_action fg_action_withdraw; /* an accepted cause; it stays in the trail */
fg_action fg_action_download; /* a lot's CSV, QIF, DFQ, report */

#endif
