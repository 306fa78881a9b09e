/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots of the database as folders that `foilgauge lot` could have made: --resume, `merge`, `lot
 * --index` and `loop --lot` accept them. */
#ifndef FG_STATION_EXPORT_H
#define FG_STATION_EXPORT_H

#include "lot/input/manifest.h"
#include "station/state.h"

/* Result of exporting a lot. */
typedef struct fg_exported_lot {
  fg_lot_outcome outcome;
  size_t replaced, withheld; /* foils: as of fg_lot_content */
  size_t again;    /* scans measured again, as their records are of another setup or program */
  size_t lost;     /* scans that could not be measured again: they count as not measured */
  char state[64];  /* of the lot as it was read */
  char words[600]; /* the result in words */
} fg_exported_lot;

/* Exports every lot ("" is "without_lot") below `folder`, which is made. Reports each through
 * the request's `looked_at`. FG_ERR_USAGE: a lot's folder holds results already. */
fg_status fg_station_export(fg_context *ctx, fg_inspection *station, const char *folder);

/* Exports one lot with its report into `folder`, which exists: judged by the setup of its newest
 * scan. Earlier results in it are replaced. Any thread. FG_ERR_USAGE: no such lot. */
fg_status fg_station_export_lot(fg_context *ctx, fg_inspection *station, const char *lot,
                                const char *folder, fg_exported_lot *exported);

/* Replaces columns that the recipe names and the manifest lacks by the usual ones. */
void fg_station_keep_columns(const fg_manifest *manifest, fg_lot_settings *settings);

#endif
