/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pages of a lot's scans: picture, verdict and every value of the foils, each in a file of the
 * lot's folder `pages`.
 *
 * A page's name holds the scan's name and a sum of everything shown: bytes and path of the scan,
 * its settings, the foil's name, the tolerances. So an existing page is valid, two scans of one
 * name have two pages, and no name of a scan does harm. */
#ifndef FG_REPORT_LOT_FOIL_PAGES_H
#define FG_REPORT_LOT_FOIL_PAGES_H

#include "lot/run/lot.h"

#define FG_LOT_PAGES "pages"

/* Makes the name of a page, "pages/foil_7-0123456789abcdef.html", relative to the lot's folder; the
 * caller frees it. Of the record, `sha256` and `measured_with` count. */
fg_status fg_lot_page_name(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_record *record, char **name);

bool fg_lot_page_exists(const char *folder, const char *name);

/* Tells whether a scan with these foils gets a page. */
fg_status fg_lot_page_is_wanted(fg_context *ctx, fg_lot_pages which, const fg_design *design,
                                const fg_foil *foils, size_t count, bool *wanted);

/* Draws the page as a text from the scan, which is read again; the caller frees it. */
fg_status fg_lot_page_draw(fg_context *ctx, const fg_design *design, const fg_manifest *manifest,
                           size_t item, const fg_measurement *measurement, char **page);

/* Makes the folder of the pages. */
fg_status fg_lot_pages_make_folder(fg_context *ctx, const char *folder);

/* Finds the existing pages by item; NULL: none. Pages that no longer belong to the lot are removed.
 * Free with fg_lot_pages_free. */
fg_status fg_lot_pages_find(fg_context *ctx, const char *folder, const fg_lot *lot, char ***names);
void fg_lot_pages_free(const fg_lot *lot, char **names);

/* Brings the pages of shards into the lot's folder: item i is of folder from[i]. */
fg_status fg_lot_pages_link(fg_context *ctx, const char *const *folders, const size_t *from,
                            const char *folder, const fg_lot *lot);

#endif
