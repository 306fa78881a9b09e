/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dispositions: the fate of foils that did not pass. */
#ifndef FG_STATION_DISPOSITION_H
#define FG_STATION_DISPOSITION_H

#include "station/pages.h"

/* SQL: the row of `foils` did not pass, was not measured again, and nobody has said its fate;
 * "measure again" waits for that. */
#define FG_FOIL_IS_OPEN                                                                            \
  "(foils.verdict IN ('fail', 'cannot_tell', 'not_measured') AND NOT EXISTS (SELECT 1 FROM"        \
  " foils AS n WHERE n.serial = foils.serial AND n.lot = foils.lot AND n.id > foils.id) AND"       \
  " coalesce((SELECT kind FROM dispositions AS d WHERE d.foil = foils.id ORDER BY d.id DESC"       \
  " LIMIT 1), 'again') = 'again')"

enum { FG_OPEN_COUNTED = 1000 };
/* Counts the open foils of a lot; NULL: of all, up to FG_OPEN_COUNTED, as every page Now asks. */
fg_status fg_disposition_count_open(fg_context *ctx, sqlite3 *connection, const char *lot,
                                    int64_t *count);

/* Writes "3 without disposition" with a link; nothing where none is open. */
fg_status fg_disposition_write_open(fg_context *ctx, sqlite3 *reader, FILE *out);

/* Writes a link to the form of an open foil: on Now a half-typed one would go with the next result.
 */
fg_status fg_disposition_write_link(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out);

/* Writes the html form of a foil that did not pass, with its disposition in force; nothing for
 * another. */
fg_status fg_disposition_write_html_form(fg_context *ctx, const fg_inspection *station,
                                         sqlite3 *reader, int64_t foil, FILE *out);

#endif
