/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages of a lot's scans: picture, verdict and every value of its foils, each in a file of the
 * folder `pages` in the lot's.
 *
 * A page's name is that of its scan and a sum of all that it shows: the scan's bytes and path, what
 * measured it, the foil's name and the tolerances. So a page that is there is one that holds, two
 * scans of one name have two pages, and no name of a scan does harm. */
#ifndef FG_REPORT_LOT_FOIL_PAGES_H
#define FG_REPORT_LOT_FOIL_PAGES_H

#include "lot/run/lot.h"

#define FG_LOT_PAGES "pages"

/* "pages/foil_7-0123456789abcdef.html", from the lot's folder; the caller frees it. Of the record,
 * `sha256` and `measured_with` count. */
fg_status fg_lot_page_name(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_record *record, char **name);

bool fg_lot_page_is_there(const char *folder, const char *name);

/* Whether these foils of a scan are to have one. */
fg_status fg_lot_page_is_wanted(fg_context *ctx, fg_lot_pages which, const fg_design *design,
                                const fg_foil *foils, size_t count, bool *wanted);

/* The page as a text, drawn from the scan, which is read again; the caller frees it. */
fg_status fg_lot_page_draw(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_measurement *measurement, char **page);

/* The folder that they lie in. */
fg_status fg_lot_pages_make(fg_context *ctx, const char *folder);

/* The names of the pages that are there, by item; NULL: none. Pages that are none of the lot's any
 * more are removed. Free with fg_lot_pages_free. */
fg_status fg_lot_pages_find(fg_context *ctx, const char *folder, const fg_lot *lot, char ***names);
void fg_lot_pages_free(const fg_lot *lot, char **names);

/* The pages of shards into the lot's folder: item i is of folder from[i]. */
fg_status fg_lot_pages_take(fg_context *ctx, const char *const *folders, const size_t *from,
                            const char *folder, const fg_lot *lot);

#endif
