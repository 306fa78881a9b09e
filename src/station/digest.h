/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A report of changes at a station, of suspected causes and of those found, as text and page. */
#ifndef FG_STATION_DIGEST_H
#define FG_STATION_DIGEST_H

#include "foilgauge/station.h"

/* Reads the database of a folder, also beside a station that runs there, and writes the digest of
 * every quantity with a tolerance (of the bump radius where there is none). `page` may be NULL.
 * FG_ERR_DATA: there is no database of this program's version. */
fg_status fg_station_digest(fg_context *ctx, const fg_station_request *request, FILE *text,
                            FILE *page);

#endif
