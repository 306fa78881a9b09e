/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts as text for receivers: JSON of their members; tables, DFQ and QIF by the writers of a lot.
 */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "lot/input/recipe.h"
#include "report/lot/files.h"
#include "station/export.h"
#include "station/outbox/part.h"

static const struct {
  const char *ending, *type;
  fg_lot_writer *write; /* NULL: JSON */
  bool csv;
} formats[] = {
    [FG_PART_JSON] = {".json", "application/json", NULL, false},
    [FG_PART_CSV] = {".csv", "text/csv; charset=utf-8", fg_lot_write_foils_csv, true},
    [FG_PART_BUMPS_CSV] = {".csv", "text/csv; charset=utf-8", fg_lot_write_bumps_csv, true},
    [FG_PART_DFQ] = {".dfq", "text/plain; charset=utf-8", fg_lot_write_dfq, false},
    [FG_PART_QIF] = {".qif", "application/xml", fg_lot_write_qif, false},
};

const char *fg_part_format_ending(fg_part_format format) {
  return formats[format].ending;
}

const char *fg_part_format_type(fg_part_format format) {
  return formats[format].type;
}

enum { SCAN, FOIL, LOT, DIE, OPERATOR, COIL, ORDER, DATE, DISPOSITION, REASON, WITHHELD, COLUMNS };

static const char *const column_names[COLUMNS] = {"scan",        "foil",   "lot",     "die",
                                                  "operator",    "coil",   "order",   "date",
                                                  "disposition", "reason", "withheld"};

/* The column of verdicts that do not hold is there where a part needs it. */
static size_t count_columns(fg_part *const *parts, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (parts[i]->stored->withheld) return COLUMNS;
  return WITHHELD;
}

static fg_status add_item(fg_context *ctx, fg_manifest *manifest, const fg_part *part,
                          size_t columns) {
  char **row, date[FG_PART_TIME];
  const char *const cells[COLUMNS] = {
      [SCAN] = part->stored->path,
      [FOIL] = part->serial,
      [LOT] = part->lot,
      [DIE] = part->die,
      [OPERATOR] = part->operator_name,
      [COIL] = part->coil,
      [ORDER] = part->order,
      [DATE] = date,
      [DISPOSITION] = part->disposition.kind,
      [REASON] = part->disposition.reason,
      [WITHHELD] = part->stored->withheld ? part->stored->withheld : "",
  };
  /* Without its milliseconds; Z, as pages show local times. */
  fg_text_clip(date, sizeof date, "%.19s%s", part->measured_at, part->measured_at[0] ? "Z" : "");
  FG_TRY(fg_manifest_add_item(ctx, manifest, &row));
  for (size_t i = 0; i < columns; i++)
    FG_TRY(fg_text_print(ctx, &row[i], "%s", cells[i]));
  return FG_OK;
}

static fg_status make_manifest(fg_context *ctx, fg_part *const *parts, size_t count,
                               fg_manifest *manifest) {
  size_t column, columns = count_columns(parts, count);
  for (size_t i = 0; i < columns; i++)
    FG_TRY(
        fg_manifest_add_column(ctx, manifest, column_names[i], strlen(column_names[i]), &column));
  for (size_t i = 0; i < count; i++)
    FG_TRY(add_item(ctx, manifest, parts[i], columns));
  return FG_OK;
}

/* A record that borrows the part's foil. */
static fg_record borrow_record(const fg_part *part) {
  const fg_stored_foil *stored = part->stored;
  fg_record record = stored->record;
  record.scan = stored->path;
  record.foils = (fg_foil *)(uintptr_t)stored->foil;
  record.foil_count = stored->foil ? 1 : 0;
  record.error = stored->readable ? NULL : (char *)(uintptr_t)stored->problem;
  return record;
}

/* Settings are those of the last part that can be read: the newest. */
static fg_status use_settings(fg_context *ctx, fg_part *const *parts, size_t count, fg_lot *lot) {
  const fg_stored_foil *newest = parts[count - 1]->stored;
  for (size_t i = count; i-- > 0 && !newest->readable;)
    newest = parts[i]->stored;
  lot->settings = newest->settings;
  fg_text_clip(lot->settings.name, sizeof lot->settings.name, "%s", parts[count - 1]->lot);
  fg_station_keep_columns(&lot->manifest, &lot->settings);
  fg_context ignored; /* more groups than are compared: the parts go without */
  if (fg_lot_check_columns(&ignored, &lot->settings, &lot->manifest) != FG_OK)
    lot->settings.group_column[0] = '\0';
  fg_text_clip(lot->head.manifest_sha256, sizeof lot->head.manifest_sha256, "%s", parts[0]->key);
  return fg_design_derive(ctx, &lot->settings.design, &lot->nominal);
}

static fg_status fill_lot(fg_context *ctx, fg_part *const *parts, size_t count, fg_lot *lot) {
  void *block;
  FG_TRY(make_manifest(ctx, parts, count, &lot->manifest));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *lot->records, &block));
  lot->records = block;
  for (size_t i = 0; i < count; i++)
    lot->records[i] = borrow_record(parts[i]);
  return use_settings(ctx, parts, count, lot);
}

typedef struct writing {
  fg_lot_writer *write;
  const fg_lot_analysis *analysis;
} writing;

static fg_status write_analysis(fg_context *ctx, void *user, FILE *out) {
  const writing *of = user;
  return of->write(ctx, of->analysis, out);
}

static fg_status write_lot(fg_context *ctx, const fg_lot *lot, fg_part_format format, FILE *out) {
  fg_lot_analysis analysis;
  FG_TRY(fg_lot_analyse(ctx, lot, &analysis));
  bool flat = fg_foil_traits_of(lot->settings.design.kind)->lies_flat;
  writing of = {formats[format].write, &analysis};
  if (flat && of.write == fg_lot_write_bumps_csv) of.write = fg_lot_write_beams_csv;
  fg_status status =
      fg_csv_write(ctx, formats[format].csv && lot->decimal_comma, write_analysis, &of, out);
  fg_lot_analysis_free(&analysis);
  return status;
}

static fg_status write_parts(fg_context *ctx, fg_part *const *parts, size_t count,
                             fg_part_format format, bool decimal_comma, FILE *out) {
  fg_lot *lot = calloc(1, sizeof *lot);
  if (!lot) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: parts");
  lot->decimal_comma = decimal_comma;
  fg_status status = fill_lot(ctx, parts, count, lot);
  if (status == FG_OK) status = write_lot(ctx, lot, format, out);
  free(lot->records); /* their foils belong to the parts */
  lot->records = NULL;
  fg_lot_free(lot);
  free(lot);
  return status;
}

fg_status fg_parts_format(fg_context *ctx, fg_part *const *parts, size_t count,
                          fg_part_format format, bool decimal_comma, char **body, size_t *size) {
  fg_status status = FG_OK;
  *body = NULL;
  FILE *out = fg_stream_open(body, size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: parts");
  if (format == FG_PART_JSON)
    fg_document_json(out, fg_part_document.members, parts[0]);
  else
    status = write_parts(ctx, parts, count, format, decimal_comma, out);
  if (!fg_stream_keep(out, body) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: parts");
  if (status != FG_OK) {
    free(*body);
    *body = NULL;
  }
  return status;
}
