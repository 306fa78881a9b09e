/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values, limits and fields of a foil, for several pages. */
#ifndef FG_STATION_VALUES_H
#define FG_STATION_VALUES_H

#include "station/correct.h"
#include "station/pages.h"

/* Writes the values that decided, each with its limits. */
fg_status fg_page_deciding(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out);

/* Writes one of them in few words, with its nearest limit. Nine columns of a row from `column`
 * on: name, owner, unit, bump, value, u, lower, upper, verdict. */
void fg_page_decided_line(const fg_query *at, int column, FILE *out);

/* Writes a sentence that names the crushed bumps; nothing where there are none. */
fg_status fg_page_crushed(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out);

/* Lists other measurements under the foil's serial number, the newest first; nothing without
 * any. */
fg_status fg_page_same_serial(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out);

typedef struct fg_foil_html_form {
  const char *back; /* the page to return to: "/", else the foil's own */
  bool focus;       /* for the barcode reader */
  bool who;         /* asks for the author of the correction */
  /* Of a correction that was held: */
  const char *asked[FG_IDENTITY_FIELDS]; /* new serial, lot, die, operator; NULL: as it is */
  const char *by;                        /* author of the correction; NULL: none given */
  const char *also; /* a serial number that may be shared, with a button for it; NULL or "": none */
} fg_foil_html_form;

/* Writes the html form for serial, lot, die and operator; `foil` is a row of id, serial, lot,
 * die, operator. It carries the values that it showed, so that only changed fields are applied
 * (fg_action_correct). */
void fg_page_foil_html_form(const fg_inspection *station, const fg_query *foil,
                            const fg_foil_html_form *html_form, FILE *out);

#endif
