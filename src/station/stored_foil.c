/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/stored_foil.h"

#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "page/page.h"
#include "page/verdict.h"
#include "report/foil_html.h"
#include "report/provenance.h"

/* NULL where the database has none. */
static fg_status copy(fg_context *ctx, const fg_query *query, int column, char **text) {
  *text = NULL;
  if (fg_query_is_null(query, column)) return FG_OK;
  *text = strdup(fg_query_get_text(query, column));
  return *text ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a foil");
}

static fg_status copy_all(fg_context *ctx, const fg_query *query, fg_stored_foil *stored) {
  char **const texts[] = {&stored->serial,        &stored->lot,     &stored->die,
                          &stored->operator_name, &stored->verdict, &stored->reasons,
                          &stored->path,          &stored->sha256,  &stored->source,
                          &stored->withheld,      &stored->program, &stored->model};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    FG_TRY(copy(ctx, query, (int)i, texts[i]));
  stored->number = (int)fg_query_get_integer(query, 12);
  stored->at = fg_query_get_integer(query, 13);
  return FG_OK;
}

/* Notes what the scale of the model of then was traced to. */
static fg_status trace_model(fg_context *ctx, fg_stored_foil *stored) {
  fg_scanner_model *model = NULL;
  if (!stored->model) return FG_OK;
  FG_TRY(fg_scanner_model_parse(ctx, "the scanner's model of then", stored->model, &model));
  fg_scanner_model_trace(model, &stored->settings.design);
  fg_scanner_model_free(model);
  return FG_OK;
}

/* Reads setup and record, as far as this program can. */
static fg_status understand(fg_context *ctx, const char *recipe, const char *record,
                            fg_stored_foil *stored) {
  fg_lot_settings_default(&stored->settings);
  FG_TRY(fg_lot_settings_parse(ctx, "the recipe of then", recipe, &stored->settings));
  FG_TRY(trace_model(ctx, stored));
  FG_TRY(fg_record_parse(ctx, record, &stored->record));
  for (size_t i = 0; i < stored->record.foil_count; i++)
    if (stored->record.foils[i].number == stored->number) stored->foil = &stored->record.foils[i];
  return stored->foil ? FG_OK : fg_fail(ctx, FG_ERR_DATA, "the record does not hold this foil");
}

static fg_status read_stored_row(fg_context *ctx, const fg_query *query, fg_stored_foil *stored) {
  fg_context inner = {.message = ""};
  FG_TRY(copy_all(ctx, query, stored));
  fg_status status =
      understand(&inner, fg_query_get_text(query, 14), fg_query_get_text(query, 15), stored);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  stored->readable = status == FG_OK;
  if (!stored->readable)
    fg_text_clip(stored->problem, sizeof stored->problem,
                 "what foilgauge %s kept of it cannot be read by foilgauge %s (%.250s)",
                 stored->program, FOILGAUGE_VERSION, inner.message);
  return FG_OK;
}

static fg_status load_stored_foil(fg_context *ctx, sqlite3 *reader, fg_stored_foil *stored) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT serial, lot, die, operator, foils.verdict, reasons, path, scans.sha256,"
                 " source, withheld, program, model, number, at, recipe, record FROM foils"
                 " JOIN scans ON scans.id = scan JOIN setups ON setups.id = setup"
                 " WHERE foils.id = ?",
                 &query);
  fg_query_integer(&query, stored->id);
  bool found = fg_query_row(&query);
  fg_status status = found ? read_stored_row(ctx, &query, stored) : FG_OK;
  fg_status ended = fg_query_end(status == FG_OK ? ctx : NULL, &query, "reading a foil");
  if (status == FG_OK) status = ended;
  if (status == FG_OK && !found) status = fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  return status;
}

fg_status fg_stored_foil_load(fg_context *ctx, sqlite3 *reader, const char *id,
                              fg_stored_foil **stored) {
  void *block;
  char *end;
  long long number = strtoll(id, &end, 10);
  *stored = NULL;
  if (!*id || *end || number <= 0) return fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **stored, &block));
  *stored = block;
  **stored = (fg_stored_foil){.id = number};
  fg_status status = load_stored_foil(ctx, reader, *stored);
  if (status == FG_OK) return FG_OK;
  fg_stored_foil_free(*stored);
  *stored = NULL;
  return status;
}

void fg_stored_foil_free(fg_stored_foil *stored) {
  if (!stored) return;
  char *const texts[] = {stored->serial,  stored->lot,      stored->die,     stored->operator_name,
                         stored->verdict, stored->reasons,  stored->path,    stored->sha256,
                         stored->source,  stored->withheld, stored->program, stored->model};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    free(texts[i]);
  fg_record_free(&stored->record);
  free(stored);
}

fg_status fg_stored_foil_write_verdict(fg_context *ctx, const fg_stored_foil *stored, FILE *out) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, &stored->settings.design, stored->foil, &decision));
  fg_html_outcome(out, &decision.outcome);
  fg_decision_free(&decision);
  return FG_OK;
}

void fg_stored_foil_write_tables(const fg_stored_foil *stored, FILE *out) {
  if (!stored->readable) {
    fputs("<p class=\"note\">The values are not shown: ", out);
    fg_html_text(out, stored->problem);
    fputs(".</p>\n", out);
    return;
  }
  if (!fg_foil_is_measured(stored->foil)) return;
  fputs("<h2>Bumps</h2>\n", out);
  fg_html_part_table(out, &stored->settings.design, stored->foil);
  fg_html_foil_table(out, &stored->settings.design, stored->foil);
}

enum { MS_PER_S = 1000 };

fg_status fg_stored_foil_write_provenance(fg_context *ctx, const fg_stored_foil *stored,
                                          FILE *out) {
  fg_scanner_model *model = NULL;
  fg_provenance from = {.version = stored->program, .of_scans = stored->readable};
  if (stored->readable) from.design = &stored->settings.design;
  fg_date_of_time(stored->at / MS_PER_S, from.first);
  fg_provenance_include_date(&from, from.first);
  if (stored->model)
    FG_TRY(fg_scanner_model_parse(ctx, "the scanner's model of then", stored->model, &model));
  from.model = model;
  fg_status status = fg_html_provenance(ctx, out, &from);
  if (model) fg_scanner_model_free(model);
  return status;
}
