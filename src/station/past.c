#include "station/past.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/scan_loop.h"
#include "report/measure/measure_page_tables.h"
#include "report/provenance.h"

/* NULL where the database has none. */
static fg_status copy(fg_context *ctx, const fg_query *query, int column, char **text) {
  *text = NULL;
  if (fg_query_is_null(query, column)) return FG_OK;
  *text = strdup(fg_query_get_text(query, column));
  return *text ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a foil");
}

static fg_status copy_all(fg_context *ctx, const fg_query *query, fg_past *past) {
  char **const texts[] = {&past->serial,  &past->lot,      &past->die,     &past->operator_name,
                          &past->verdict, &past->reasons,  &past->path,    &past->sha256,
                          &past->source,  &past->withheld, &past->program, &past->model};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    FG_TRY(copy(ctx, query, (int)i, texts[i]));
  past->number = (int)fg_query_get_integer(query, 12);
  past->at = fg_query_get_integer(query, 13);
  return FG_OK;
}

/* What the setup and the record say, as far as this program can read it. */
static fg_status understand(fg_context *ctx, const char *recipe, const char *record,
                            fg_past *past) {
  fg_lot_settings_default(&past->settings);
  FG_TRY(fg_lot_settings_parse(ctx, "the recipe of then", recipe, &past->settings));
  FG_TRY(fg_record_parse(ctx, record, &past->record));
  for (size_t i = 0; i < past->record.foil_count; i++)
    if (past->record.foils[i].number == past->number) past->foil = &past->record.foils[i];
  return past->foil ? FG_OK : fg_fail(ctx, FG_ERR_DATA, "the record does not hold this foil");
}

static fg_status read_row(fg_context *ctx, const fg_query *query, fg_past *past) {
  fg_context inner = {.message = ""};
  FG_TRY(copy_all(ctx, query, past));
  fg_status status =
      understand(&inner, fg_query_get_text(query, 14), fg_query_get_text(query, 15), past);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  past->readable = status == FG_OK;
  if (!past->readable)
    fg_text_clip(past->problem, sizeof past->problem,
                 "what foilgauge %s kept of it cannot be read by foilgauge %s (%.250s)",
                 past->program, FOILGAUGE_VERSION, inner.message);
  return FG_OK;
}

static fg_status load(fg_context *ctx, sqlite3 *reader, fg_past *past) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT serial, lot, die, operator, foils.verdict, reasons, path, scans.sha256,"
                 " source, withheld, program, model, number, at, recipe, record FROM foils"
                 " JOIN scans ON scans.id = scan JOIN setups ON setups.id = setup"
                 " WHERE foils.id = ?",
                 &query);
  fg_query_integer(&query, past->id);
  bool found = fg_query_row(&query);
  fg_status status = found ? read_row(ctx, &query, past) : FG_OK;
  fg_status ended = fg_query_end(status == FG_OK ? ctx : NULL, &query, "reading a foil");
  if (status == FG_OK) status = ended;
  if (status == FG_OK && !found) status = fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  return status;
}

fg_status fg_past_load(fg_context *ctx, sqlite3 *reader, const char *id, fg_past **past) {
  void *block;
  char *end;
  long long number = strtoll(id, &end, 10);
  *past = NULL;
  if (!*id || *end || number <= 0) return fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **past, &block));
  *past = block;
  **past = (fg_past){.id = number};
  fg_status status = load(ctx, reader, *past);
  if (status == FG_OK) return FG_OK;
  fg_past_free(*past);
  *past = NULL;
  return status;
}

void fg_past_free(fg_past *past) {
  if (!past) return;
  char *const texts[] = {past->serial,  past->lot,      past->die,     past->operator_name,
                         past->verdict, past->reasons,  past->path,    past->sha256,
                         past->source,  past->withheld, past->program, past->model};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    free(texts[i]);
  fg_record_free(&past->record);
  free(past);
}

fg_status fg_past_write_verdict(fg_context *ctx, const fg_past *past, FILE *out) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, &past->settings.design, past->foil, &decision));
  fg_html_outcome(out, &decision.outcome);
  fg_decision_free(&decision);
  return FG_OK;
}

void fg_past_write_tables(const fg_past *past, FILE *out) {
  if (!past->readable) {
    fputs("<p class=\"note\">The values are not shown: ", out);
    fg_html_text(out, past->problem);
    fputs(".</p>\n", out);
    return;
  }
  if (!fg_foil_is_measured(past->foil)) return;
  fputs("<h2>Bumps</h2>\n", out);
  fg_html_part_table(out, &past->settings.design, past->foil);
  fg_html_foil_table(out, &past->settings.design, past->foil);
}

enum { MS_PER_S = 1000 };

fg_status fg_past_write_provenance(fg_context *ctx, const fg_past *past, FILE *out) {
  fg_scanner_model *model = NULL;
  fg_provenance from = {.version = past->program, .of_scans = past->readable};
  if (past->readable) from.design = &past->settings.design;
  fg_date_of_time(past->at / MS_PER_S, from.first);
  fg_provenance_take_date(&from, from.first);
  if (past->model)
    FG_TRY(fg_scanner_model_parse(ctx, "the scanner's model of then", past->model, &model));
  from.model = model;
  fg_status status = fg_html_provenance(ctx, out, &from);
  if (model) fg_scanner_model_free(model);
  return status;
}
