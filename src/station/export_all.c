/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every lot of the database as a folder. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/folder.h"
#include "core/memory.h"
#include "core/text.h"
#include "lot/run/lot.h"
#include "station/export.h"
#include "station/lot_folder.h"

typedef struct lot_names {
  char **name;
  size_t count, capacity;
} lot_names;

static fg_status list_lots(fg_context *ctx, fg_inspection *station, lot_names *lots) {
  fg_query query;
  fg_status status = FG_OK;
  fg_query_begin(station->database.reader, "SELECT DISTINCT lot FROM foils ORDER BY lot", &query);
  while (status == FG_OK && fg_query_row(&query)) {
    void *block = lots->name;
    status = fg_memory_reserve(ctx, lots->count + 1, sizeof *lots->name, &lots->capacity, &block);
    lots->name = block;
    if (status != FG_OK) break;
    lots->name[lots->count] = NULL;
    status = fg_text_print(ctx, &lots->name[lots->count++], "%s", fg_query_get_text(&query, 0));
  }
  fg_status ended = fg_query_end(ctx, &query, "reading the lots");
  return status == FG_OK ? ended : status;
}

/* Nobody's results are overwritten. */
static fg_status prepare_folder(fg_context *ctx, const char *folder) {
  char *results;
  FG_TRY(fg_folder_make(ctx, folder));
  FG_TRY(fg_lot_path(ctx, folder, "results.jsonl", &results));
  bool there = access(results, F_OK) == 0;
  free(results);
  if (!there) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE, "%s: the folder holds results; choose another for --export",
                 folder);
}

static fg_status export_one(fg_context *ctx, fg_inspection *station, const char *below,
                            const char *lot) {
  char name[FG_LOT_FOLDER_NAME], *folder;
  fg_exported_lot exported;
  fg_lot_folder_name(lot, name);
  FG_TRY(fg_text_print(ctx, &folder, "%s/%s", below, name));
  fg_status status = prepare_folder(ctx, folder);
  if (status == FG_OK) status = fg_station_export_lot(ctx, station, lot, folder, &exported);
  if (status == FG_OK) {
    fg_outcome_add(&station->outcome->judged, &exported.outcome.judged);
    if (station->request->looked_at)
      station->request->looked_at(station->request->user, folder, exported.words);
  }
  free(folder);
  return status;
}

fg_status fg_station_export(fg_context *ctx, fg_inspection *station, const char *folder) {
  lot_names lots = {0};
  fg_status status = list_lots(ctx, station, &lots);
  if (status == FG_OK && !lots.count)
    status =
        fg_fail(ctx, FG_ERR_DATA, "%s: the database holds no foil yet", station->request->folder);
  if (status == FG_OK) status = fg_folder_make(ctx, folder);
  for (size_t i = 0; i < lots.count && status == FG_OK; i++)
    status = export_one(ctx, station, folder, lots.name[i]);
  for (size_t i = 0; i < lots.count; i++)
    free(lots.name[i]);
  free(lots.name);
  return status;
}
