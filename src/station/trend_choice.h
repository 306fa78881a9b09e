/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The user's choice of a trend: a quantity, foils or lots, and the points that are drawn. */
#ifndef FG_STATION_TREND_CHOICE_H
#define FG_STATION_TREND_CHOICE_H

#include "foilgauge/quantity.h"
#include "station/naming.h"
#include "station/pages.h"

/* The choice in the page's html form. Points are counted from the first of the selection, from
 * 1: their numbers stay when new foils come. */
typedef struct fg_trend_choice {
  fg_quantity_owner owner;
  const fg_quantity *row;
  int bump; /* 0: the mean over a foil's bumps, or the whole foil */
  char lot[FG_IDENTITY_BYTES], die[FG_IDENTITY_BYTES]; /* "": any */
  bool by_lots;
  size_t newest;                /* points of the chart; 0: all */
  size_t from, to;              /* points that are drawn; 0: not given */
  bool of_the_drawn;            /* the chart's limits come from the drawn points alone */
  const struct fg_cause *found; /* causes that are treated as accepted ones; not owned */
  size_t found_count;
  bool taken_out; /* values are drawn without the causes */
} fg_trend_choice;

/* Writes hidden fields of an html form: the choice's quantity, bump, lot and die. */
void fg_trend_write_hidden(FILE *out, const fg_trend_choice *choice);

/* FG_ERR_USAGE: there is no such quantity. */
fg_status fg_trend_choose(fg_context *ctx, const fg_inspection *station, const fg_request *request,
                          fg_trend_choice *choice);

/* Chooses a quantity of bumps, else of foils, by its name; false: there is none for charts. */
bool fg_trend_choose_named(const char *name, size_t newest, fg_trend_choice *choice);

/* Writes the choice as a query, "?q=...", HTML-safe; with other points drawn, unless both are 0. */
void fg_trend_write_link(FILE *out, const fg_trend_choice *choice, size_t from, size_t to);

/* Writes a page's address with the choice's quantity, bump, lot and die: "/why?q=...". */
void fg_trend_write_query(FILE *out, const char *page, const fg_trend_choice *choice);

/* Writes "bump:height_mm", as the query has it. */
void fg_trend_write_name(FILE *out, fg_quantity_owner owner, const fg_quantity *row);

/* Finds the number of its quantity in the database; 0: it has no value yet. */
fg_status fg_trend_find_quantity(fg_context *ctx, sqlite3 *reader, const fg_trend_choice *choice,
                                 int64_t *id);

/* Writes the html form of the choice. */
fg_status fg_trend_write_html_form(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                   const fg_trend_choice *choice, FILE *out);

#endif
