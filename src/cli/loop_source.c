/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/loop_source.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/runs.h"
#include "foilgauge/forming.h"
#include "foilgauge/memory.h"
#include "foilgauge/table_remarks.h"
#include "foilgauge/text.h"

/* Levels of a column at most. Names with more are no levels of an effect: they may be a count. */
enum { LEVELS_MAX = FG_LOOP_COLUMNS };

static const char scan_column[] = "scan";

fg_status fg_loop_source_check(fg_context *ctx, const fg_loop_source_request *request,
                               fg_output_set *outputs) {
  static const char *const files[] = {"results.jsonl", "manifest.csv", "recipe.json", "lot.json",
                                      "index.html",    "foils.csv",    "bumps.csv",   "beams.csv"};
  const fg_input tables[] = {{request->table, "the table"},
                             {request->runs, "the table of runs"},
                             {request->forming_model, "the forming"}};
  FG_TRY(fg_output_set_check(ctx, outputs, tables, sizeof tables / sizeof *tables));
  for (size_t i = 0; request->lot && i < sizeof files / sizeof *files; i++) {
    char *path = NULL;
    FG_TRY(fg_text_print(ctx, &path, "%s/%s", request->lot, files[i]));
    fg_status status = fg_output_set_check(ctx, outputs, &(fg_input){path, "a file of the lot"}, 1);
    free(path);
    FG_TRY(status);
  }
  return FG_OK;
}

static fg_status drop_columns(fg_context *ctx, const fg_loop_source_request *request,
                              fg_table *table) {
  for (size_t i = 0; i < request->withouts; i++)
    FG_TRY(fg_table_drop(ctx, table, request->without[i]));
  return FG_OK;
}

/* Columns with fewer than half of their cells are comments: they cost no rows. */
static bool is_column_filled(const fg_column *column, size_t rows) {
  return 2 * column->missing_count < rows;
}

static bool is_row_complete(const fg_table *table, size_t row) {
  for (size_t c = 0; c < table->columns; c++) {
    const fg_column *column = &table->column[c];
    if (is_column_filled(column, table->rows) && column->word &&
        column->word[row] == FG_TABLE_MISSING)
      return false;
  }
  return true;
}

/* Rows keep the numbers that they have in the file. */
static fg_status name_rows(fg_context *ctx, fg_loop_source *source, const size_t *row,
                           size_t count) {
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *source->name, (void **)&source->name));
  source->names = count;
  for (size_t i = 0; i < count; i++)
    FG_TRY(fg_text_print(ctx, &source->name[i], "row %zu", row[i] + 1));
  source->row_name = (const char *const *)source->name;
  return FG_OK;
}

static fg_status keep_complete_rows(fg_context *ctx, fg_loop_source *source) {
  fg_table complete = {0}, *table = &source->read;
  size_t *row = NULL, kept = 0, rows = table->rows;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *row, (void **)&row));
  for (size_t i = 0; i < rows; i++)
    if (is_row_complete(table, i)) row[kept++] = i;
  if (kept == rows) goto exit;
  if (!kept) {
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%s: every row has an empty cell; --without COLUMN leaves "
                     "out a column",
                     table->source);
    goto exit;
  }
  FG_TRY_EXIT(fg_table_select(ctx, table, row, kept, &complete));
  fg_table_free(table);
  *table = complete;
  FG_TRY_EXIT(name_rows(ctx, source, row, kept));
  FG_TRY_EXIT(fg_text_append_remark(
      ctx, &source->said, "left out: %zu of %zu rows, with an empty cell", rows - kept, rows));
exit:
  free(row);
  return status;
}

static fg_status read_table(fg_context *ctx, const fg_loop_source_request *request,
                            fg_loop_table_spec *spec, fg_loop_source *source) {
  source->path = request->table;
  FG_TRY(fg_table_load(ctx, request->table, &source->read, source->sha256));
  source->table = &source->read;
  FG_TRY(drop_columns(ctx, request, &source->read));
  FG_TRY(fg_table_remark(ctx, &source->read, spec->response, &source->said));
  if (request->complete) FG_TRY(keep_complete_rows(ctx, source));
  return fg_loop_table_count_times(ctx, &source->read, spec, &source->said);
}

static fg_status read_lot(fg_context *ctx, const fg_loop_source_request *request,
                          fg_loop_table_spec *spec, fg_design *design, fg_loop_source *source) {
  fg_lot_table *lot = &source->lot;
  const fg_lot_table_options options = {.quantity = spec->response,
                                        .with_radius = !strcmp(spec->model, "arc_length"),
                                        .without = request->without,
                                        .withouts = request->withouts};
  FG_TRY(fg_lot_table_read(ctx, request->lot, &options, lot));
  FG_TRY(fg_memory_allocate(ctx, 2, sizeof *source->input, (void **)&source->input));
  for (size_t i = 0; i < 2; i++)
    source->input[i] = (fg_loop_input){lot->path[i + 1], lot->sha256[i + 1]};
  source->inputs = 2;
  source->table = &lot->table;
  source->path = lot->path[0];
  memcpy(source->sha256, lot->sha256[0], sizeof source->sha256);
  source->row_name = (const char *const *)lot->name;
  source->said = lot->said;
  lot->said = NULL;
  if (!spec->group) spec->group = lot->group;
  if (!request->has_design) *design = lot->design;
  return FG_OK;
}

/* --scans is a folder, or as in `doe` the column that names the scans. */
static void choose_scans(const fg_loop_source_request *request, fg_runs_scans *how) {
  struct stat about;
  how->column = scan_column;
  if (!request->scans) return;
  if (stat(request->scans, &about) == 0 && S_ISDIR(about.st_mode))
    how->folder = request->scans;
  else
    how->column = request->scans;
}

static fg_status name_runs(fg_context *ctx, fg_loop_source *source) {
  const fg_run_sheet *measured = &source->measured;
  FG_TRY(
      fg_memory_allocate(ctx, measured->table.rows, sizeof *source->name, (void **)&source->name));
  source->names = measured->table.rows;
  for (size_t i = 0; i < measured->table.rows; i++)
    FG_TRY(fg_text_print(ctx, &source->name[i], "run %zu", measured->row[i]));
  source->row_name = (const char *const *)source->name;
  FG_TRY(fg_memory_allocate(ctx, measured->scans, sizeof *source->input, (void **)&source->input));
  for (size_t i = 0; i < measured->scans; i++)
    source->input[i] = (fg_loop_input){measured->scan[i].path, measured->scan[i].sha256};
  source->inputs = measured->scans;
  source->failed = measured->failed > 0;
  if (!measured->failed && !measured->empty) return FG_OK;
  return fg_text_append_remark(ctx, &source->said,
                               "left out: %zu run%s without a scan, %zu scan%s that "
                               "could not be measured",
                               measured->empty, fg_plural(measured->empty), measured->failed,
                               fg_plural(measured->failed));
}

/* Missing columns are reported before the scans are measured. */
static fg_status check_columns(fg_context *ctx, const fg_loop_table_spec *spec,
                               const fg_table *sheet) {
  const fg_column *column;
  if (spec->group) FG_TRY(fg_table_find(ctx, sheet, spec->group, &column));
  return spec->order ? fg_table_find(ctx, sheet, spec->order, &column) : FG_OK;
}

static fg_status read_runs(fg_context *ctx, const fg_loop_source_request *request,
                           fg_output_set *outputs, const fg_loop_table_spec *spec,
                           const fg_design *design, fg_loop_source *source) {
  fg_runs_scans how = {.sheet_path = request->runs,
                       .quantity = spec->response,
                       .design = design,
                       .measure = {.dpi = request->dpi,
                                   .threads = request->threads,
                                   .allow_lossy = request->allow_lossy},
                       .outputs = outputs};
  choose_scans(request, &how);
  source->path = request->runs;
  FG_TRY(fg_table_load(ctx, request->runs, &source->read, source->sha256));
  FG_TRY(drop_columns(ctx, request, &source->read));
  FG_TRY(check_columns(ctx, spec, &source->read));
  FG_TRY(fg_runs_measure(ctx, &source->read, &how, &source->measured));
  fg_table *table = &source->measured.table;
  source->table = table;
  FG_TRY(fg_table_drop(ctx, table, how.column));
  FG_TRY(fg_table_count_words(ctx, table, LEVELS_MAX, &source->said));
  return name_runs(ctx, source);
}

/* ---- a forming as the declared model ---- */

static const char declared_column[] = "declared", bump_column[] = "bump";

static fg_status predict_rows(fg_context *ctx, const fg_forming_prediction *prediction,
                              const char *response, const fg_table *table, double *predicted,
                              double *apart) {
  const fg_extended *number, *measured;
  FG_TRY(fg_table_numbers(ctx, table, bump_column, &number));
  FG_TRY(fg_table_numbers(ctx, table, response, &measured));
  *apart = 0;
  for (size_t i = 0; i < table->rows; i++) {
    double bump = number[i].value;
    if (bump != floor(bump) || fabs(bump) > 1e6)
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: bump is %g, which is no bump's number",
                     table->source, i + 1, bump);
    FG_TRY(fg_forming_predict(ctx, prediction, (int)bump, response, &predicted[i]));
    *apart += (measured[i].value - predicted[i]) / (double)table->rows;
  }
  return FG_OK;
}

static fg_status note_prediction(fg_context *ctx, const fg_forming_prediction *prediction,
                                 const char *response, double apart, fg_loop_source *source) {
  fg_loop_input *inputs = NULL;
  FG_TRY(fg_text_print(ctx, &source->forming_path, "%s", prediction->path));
  memcpy(source->forming_sha256, prediction->sha256, sizeof source->forming_sha256);
  FG_TRY(fg_memory_allocate(ctx, source->inputs + 1, sizeof *inputs, (void **)&inputs));
  if (source->inputs) memcpy(inputs, source->input, source->inputs * sizeof *inputs);
  inputs[source->inputs++] = (fg_loop_input){source->forming_path, source->forming_sha256};
  free(source->input);
  source->input = inputs;
  return fg_text_append_remark(
      ctx, &source->said,
      "declared: what %s (foilgauge forming) predicts of %s by the bump's number; "
      "measured minus predicted is %+.6g on average",
      prediction->path, response, apart);
}

/* Declares a forming: its prediction of every row becomes the offset. */
static fg_status declare_forming(fg_context *ctx, const char *path, fg_table *table,
                                 fg_loop_table_spec *spec, fg_loop_source *source) {
  fg_forming_prediction *prediction = NULL;
  double *predicted = NULL, apart = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *prediction, (void **)&prediction));
  FG_TRY_EXIT(fg_forming_prediction_load(ctx, path, prediction));
  FG_TRY_EXIT(fg_memory_allocate(ctx, table->rows, sizeof *predicted, (void **)&predicted));
  FG_TRY_EXIT(predict_rows(ctx, prediction, spec->response, table, predicted, &apart));
  FG_TRY_EXIT(fg_table_add_numbers(ctx, table, declared_column, predicted, table->rows));
  FG_TRY_EXIT(note_prediction(ctx, prediction, spec->response, apart, source));
  spec->offset = declared_column;
exit:
  free(predicted);
  free(prediction);
  return status;
}

static fg_status read_source(fg_context *ctx, const fg_loop_source_request *request,
                             fg_output_set *outputs, fg_loop_table_spec *spec, fg_design *design,
                             fg_loop_source *source) {
  if (request->lot) return read_lot(ctx, request, spec, design, source);
  if (request->runs) return read_runs(ctx, request, outputs, spec, design, source);
  return read_table(ctx, request, spec, source);
}

static fg_table *table_of(const fg_loop_source_request *request, fg_loop_source *source) {
  return request->lot    ? &source->lot.table
         : request->runs ? &source->measured.table
                         : &source->read;
}

fg_status fg_loop_source_read(fg_context *ctx, const fg_loop_source_request *request,
                              fg_output_set *outputs, fg_loop_table_spec *spec, fg_design *design,
                              fg_loop_source *source) {
  *source = (fg_loop_source){0};
  FG_TRY(read_source(ctx, request, outputs, spec, design, source));
  if (!request->forming_model) return FG_OK;
  return declare_forming(ctx, request->forming_model, table_of(request, source), spec, source);
}

void fg_loop_source_free(fg_loop_source *source) {
  for (size_t i = 0; i < source->names; i++)
    free(source->name[i]);
  free(source->name);
  free(source->input);
  free(source->said);
  free(source->forming_path);
  fg_table_free(&source->read);
  fg_lot_table_free(&source->lot);
  fg_run_sheet_free(&source->measured);
  *source = (fg_loop_source){0};
}
