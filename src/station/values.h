/* Values, limits and fields of a foil, as several pages show them. */
#ifndef FG_STATION_VALUES_H
#define FG_STATION_VALUES_H

#include "station/pages.h"

/* The values that decided, each with its limits. */
fg_status fg_page_deciding(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out);

/* The form for serial, lot, die and operator; `foil` is a row of id, serial, lot, die, operator.
 * `back`: the page to return to. `focus`: for the barcode reader. */
void fg_page_foil_form(const fg_inspection *station, const fg_query *foil, const char *back,
                       bool focus, FILE *out);

#endif
