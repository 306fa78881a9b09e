/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured scan as rows: the scan, its foils and bumps, every quantity, the deciding values. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/select.h"
#include "foilgauge/words.h"
#include "lot/run/lot.h"
#include "lot/run/record.h"
#include "quantity/quantity_rows.h"
#include "station/keep.h"

enum { DECIDING_MAX = 3, WORDS = 600 };

static const char *const owner_words[FG_QUANTITY_OWNERS] = {
    [FG_QUANTITY_OF_FOIL] = "foil",       [FG_QUANTITY_OF_BUMP] = "bump",
    [FG_QUANTITY_OF_DISC] = "disc",       [FG_QUANTITY_OF_STRIP] = "strip",
    [FG_QUANTITY_OF_BEARING] = "bearing",
};

/* The number of a quantity's row; it is made with the first value. */
static fg_status find_quantity(fg_context *ctx, sqlite3 *writer, fg_quantity_owner owner,
                               const fg_quantity *row, int64_t *id) {
  fg_query query;
  fg_query_begin(writer, "SELECT id FROM quantities WHERE owner = ? AND name = ?", &query);
  fg_query_text(&query, owner_words[owner]);
  fg_query_text(&query, row->name);
  *id = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  FG_TRY(fg_query_end(ctx, &query, "reading the quantities"));
  if (*id) return FG_OK;
  fg_query_begin(writer, "INSERT INTO quantities (owner, name, unit) VALUES (?, ?, ?)", &query);
  fg_query_text(&query, owner_words[owner]);
  fg_query_text(&query, row->name);
  fg_query_text(&query, row->unit);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a quantity"));
  *id = fg_sqlite.last_insert_rowid(writer);
  return FG_OK;
}

static fg_status keep_measured(fg_context *ctx, sqlite3 *writer, fg_quantity_owner owner,
                               int64_t foil, int bump, const void *object) {
  size_t count;
  fg_query query;
  int64_t quantity;
  fg_status status = FG_OK;
  const fg_quantity *rows = fg_quantities(owner, &count);
  fg_query_begin(writer,
                 "INSERT INTO measured (quantity, foil, bump, value, u) VALUES (?, ?, ?, ?, ?)",
                 &query);
  for (size_t i = 0; i < count && status == FG_OK; i++) {
    if (rows[i].kind == FG_QUANTITY_PAIR) continue; /* places on the glass: in the record */
    status = find_quantity(ctx, writer, owner, &rows[i], &quantity);
    fg_query_integer(&query, quantity);
    fg_query_integer(&query, foil);
    fg_query_integer(&query, bump);
    fg_query_number(&query, fg_quantity_value(&rows[i], object));
    fg_query_number(&query, fg_quantity_uncertainty(&rows[i], object));
    fg_query_row(&query);
    fg_query_again(&query);
  }
  fg_status ended = fg_query_end(ctx, &query, "keeping a value");
  return status == FG_OK ? ended : status;
}

static void list_flags(unsigned flags, const fg_flag_words *words, char *text, size_t size) {
  size_t length = 0;
  text[0] = '\0';
  for (; words->name; words++)
    if (flags & words->flag && length < size)
      length +=
          (size_t)snprintf(text + length, size - length, "%s%s", length ? " " : "", words->name);
}

static fg_status keep_bump(fg_context *ctx, sqlite3 *writer, const fg_design *design,
                           const fg_foil *foil, const fg_bump *bump, int64_t id) {
  fg_query query;
  char flags[WORDS];
  list_flags(fg_bump_flags(design, foil, bump), fg_bump_flag_words(), flags, sizeof flags);
  fg_query_begin(writer, "INSERT INTO bumps (foil, number, verdict, flags) VALUES (?, ?, ?, ?)",
                 &query);
  fg_query_integer(&query, id);
  fg_query_integer(&query, bump->number);
  fg_query_text(&query, fg_verdict_word(fg_bump_verdict(design, foil, bump)));
  fg_query_text(&query, flags);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a bump"));
  return keep_measured(ctx, writer, FG_QUANTITY_OF_BUMP, id, bump->number, bump);
}

static int by_severity(const void *a, const void *b) {
  return fg_judgement_compare(a, b);
}

static fg_status keep_deciding(fg_context *ctx, sqlite3 *writer, fg_decision *decision,
                               int64_t foil) {
  fg_query query;
  int64_t quantity;
  fg_status status = FG_OK;
  if (decision->count)
    fg_sort_items(decision->judgements, decision->count, sizeof *decision->judgements, by_severity);
  fg_query_begin(
      writer,
      "INSERT INTO deciding (foil, rank, quantity, bump, value, u, lower, upper, verdict)"
      " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
      &query);
  for (size_t i = 0; i < decision->count && i < DECIDING_MAX && status == FG_OK; i++) {
    const fg_judgement *judgement = &decision->judgements[i];
    fg_quantity_owner owner = judgement->number ? FG_QUANTITY_OF_BUMP : FG_QUANTITY_OF_FOIL;
    status = find_quantity(ctx, writer, owner, judgement->row, &quantity);
    fg_query_integer(&query, foil);
    fg_query_integer(&query, (int64_t)i);
    fg_query_integer(&query, quantity);
    fg_query_integer(&query, judgement->number);
    fg_query_number(&query, judgement->value);
    fg_query_number(&query, judgement->u);
    fg_query_number(&query, judgement->tolerance->lower);
    fg_query_number(&query, judgement->tolerance->upper);
    fg_query_text(&query, fg_verdict_word(judgement->verdict));
    fg_query_row(&query);
    fg_query_again(&query);
  }
  fg_status ended = fg_query_end(ctx, &query, "keeping what decided");
  return status == FG_OK ? ended : status;
}

/* Writes in plain words the reasons that no value gives. */
static void find_reasons(const fg_design *design, const fg_foil *foil, char *text, size_t size) {
  char defect[256];
  if (!fg_foil_is_measured(foil))
    snprintf(text, size, "%s", foil->error);
  else if (fg_foil_defect(design, foil, defect, sizeof defect))
    snprintf(text, size, "%s", defect);
  else
    text[0] = '\0';
}

static fg_status insert_foil(fg_context *ctx, sqlite3 *writer, const fg_station_scan *kept,
                             const fg_foil *foil, int64_t scan, fg_verdict verdict) {
  fg_query query;
  char serial[FG_NAMED_TEXT + 16], reasons[WORDS];
  const fg_named *named = kept->named;
  /* A bed has one name and many foils. */
  if (kept->measurement->foil_count > 1)
    snprintf(serial, sizeof serial, "%s.%d", named->serial, foil->number);
  else
    strcpy(serial, named->serial);
  find_reasons(&kept->settings->design, foil, reasons, sizeof reasons);
  fg_query_begin(writer,
                 "INSERT INTO foils (scan, number, serial, lot, die, operator, verdict, reasons,"
                 " coil, oven, scanner, order_id) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                 &query);
  fg_query_integer(&query, scan);
  fg_query_integer(&query, foil->number);
  fg_query_text(&query, serial);
  fg_query_text(&query, named->lot);
  fg_query_text(&query, named->die);
  fg_query_text(&query, named->operator_name);
  fg_query_text(&query, fg_verdict_word(verdict));
  fg_query_text(&query, reasons);
  fg_query_text(&query, named->coil);
  fg_query_text(&query, named->oven);
  fg_query_text(&query, named->scanner);
  fg_query_integer(&query, kept->order);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a foil");
}

static fg_status keep_foil(fg_context *ctx, sqlite3 *writer, const fg_station_scan *kept,
                           const fg_foil *foil, int64_t scan) {
  fg_decision decision;
  const fg_design *design = &kept->settings->design;
  FG_TRY(fg_foil_decide(ctx, design, foil, &decision));
  fg_status status = insert_foil(ctx, writer, kept, foil, scan, decision.outcome.verdict);
  int64_t id = fg_sqlite.last_insert_rowid(writer);
  bool measured = fg_foil_is_measured(foil);
  if (status == FG_OK) status = keep_deciding(ctx, writer, &decision, id);
  if (status == FG_OK && measured)
    status = keep_measured(ctx, writer, FG_QUANTITY_OF_FOIL, id, 0, foil);
  for (size_t i = 0; measured && i < foil->bump_count && status == FG_OK; i++)
    status = keep_bump(ctx, writer, design, foil, &foil->bumps[i], id);
  fg_decision_free(&decision);
  return status == FG_OK ? fg_event_keep(ctx, writer, id, FG_EVENT_MEASURED) : status;
}

static fg_status format_record(fg_context *ctx, const fg_station_scan *kept, char **line) {
  size_t length;
  fg_record record = {.scan = (char *)(uintptr_t)kept->file.name};
  memcpy(record.sha256, kept->measurement->sha256, sizeof record.sha256);
  fg_date_of_time(kept->file.modified_ns / 1000000000, record.date);
  FG_TRY(fg_lot_sum_settings(ctx, kept->settings, record.measured_with));
  return fg_record_format(ctx, &record, kept->measurement, line, &length);
}

static fg_status insert_scan(fg_context *ctx, sqlite3 *writer, const fg_station_scan *kept,
                             fg_verdict verdict, const char *record) {
  fg_query query;
  const fg_measurement *measurement = kept->measurement;
  fg_query_begin(writer,
                 "INSERT INTO scans (sha256, setup, path, source, at, dpi_x, dpi_y, width_px,"
                 " height_px, verdict, withheld, error, record, seconds)"
                 " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                 &query);
  fg_query_text(&query, measurement->sha256);
  fg_query_integer(&query, kept->setup);
  fg_query_text(&query, kept->file.name);
  fg_query_text(&query, kept->source);
  fg_query_integer(&query, fg_station_now());
  fg_query_number(&query, measurement->dpi[0]);
  fg_query_number(&query, measurement->dpi[1]);
  fg_query_integer(&query, measurement->file.width_px);
  fg_query_integer(&query, measurement->file.height_px);
  fg_query_text(&query, fg_verdict_word(verdict));
  fg_query_text(&query, kept->withheld);
  fg_query_text(&query, measurement->warning[0] ? measurement->warning : NULL);
  fg_query_text(&query, record);
  fg_query_number(&query, kept->seconds);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a scan");
}

static fg_status keep_rows(fg_context *ctx, fg_station_database *database,
                           const fg_station_scan *kept, fg_verdict verdict, const char *record,
                           int64_t *scan) {
  sqlite3 *writer = database->writer;
  FG_TRY(insert_scan(ctx, writer, kept, verdict, record));
  *scan = fg_sqlite.last_insert_rowid(writer);
  for (size_t i = 0; i < kept->measurement->foil_count; i++)
    FG_TRY(keep_foil(ctx, writer, kept, &kept->measurement->foils[i], *scan));
  return fg_station_insert_card(ctx, database, &kept->file, FG_CARD_MEASURED, kept->note, *scan);
}

fg_status fg_station_keep_scan(fg_context *ctx, fg_station_database *database,
                               const fg_station_scan *kept, int64_t *scan,
                               fg_report_outcome *outcome) {
  char *record;
  const fg_report_scan judged = {.path = kept->file.name, .measurement = kept->measurement};
  FG_TRY(fg_report_judge_scan(ctx, &kept->settings->design, &judged, outcome));
  FG_TRY(format_record(ctx, kept, &record));
  fg_status status = fg_station_database_begin(ctx, database);
  if (status == FG_OK) {
    status = keep_rows(ctx, database, kept, outcome->verdict, record, scan);
    status = fg_station_database_end(ctx, database, status);
  }
  free(record);
  return status;
}
