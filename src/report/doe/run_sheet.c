/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/run_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"
#include "quantity/parts.h"
#include "quantity/quantity_rows.h"

/* A mean as it grows: independent parts add in squares, common ones as they are. */
typedef struct mean {
  double sum, squares, common;
  size_t count;
} mean;

static void add_to_mean(mean *m, double value, double u) {
  if (!isfinite(value)) return;
  m->sum += value;
  m->squares += u * u;
  m->common += u;
  m->count++;
}

typedef struct measuring {
  const fg_run_sheet_options *options;
  const fg_quantity *row;
  fg_quantity_owner owner;
  size_t scan_capacity;
  fg_run_sheet *out;
  double *value, *u; /* of the runs that are kept */
} measuring;

static fg_status find_quantity(fg_context *ctx, measuring *m) {
  fg_foil_kind kind = m->options->design->kind;
  const fg_quantity_owner owners[] = {FG_QUANTITY_OF_FOIL, fg_foil_kind_parts(kind)};
  char list[700] = "";
  for (size_t i = fg_foil_traits_of(kind)->is_foil ? 0 : 1; i < 2; i++) {
    const fg_quantity *found = fg_quantity_find(owners[i], m->options->quantity);
    fg_quantity_list(owners[i], kind, false, list, sizeof list);
    if (!found || found->kind != FG_QUANTITY_NUMBER) continue;
    m->row = found;
    m->owner = owners[i];
    return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_DATA, "'%s' is no quantity that a scan gives; there are: %s",
                 m->options->quantity, list);
}

static void add_object(const measuring *m, const void *object, mean *parts) {
  add_to_mean(parts, fg_quantity_value(m->row, object), fg_quantity_uncertainty(m->row, object));
}

/* Mean over the bumps (or beams, or discs) of one foil; both kinds of uncertainty. */
static void add_parts(const measuring *m, const mean *parts, mean *foils) {
  if (!parts->count) return;
  double n = (double)parts->count;
  double u = m->row->uses & FG_QUANTITY_IS_OWN ? sqrt(parts->squares) / n : parts->common / n;
  add_to_mean(foils, parts->sum / n, u);
}

static void read_measurement(const measuring *m, const fg_measurement *measurement,
                             fg_experiment_scan *scan) {
  mean foils = {0};
  memcpy(scan->sha256, measurement->sha256, sizeof scan->sha256);
  for (size_t i = 0; i < measurement->foil_count; i++) {
    const fg_foil *foil = &measurement->foils[i];
    mean parts = {0};
    if (m->owner == FG_QUANTITY_OF_FOIL) add_object(m, foil, &parts);
    for (size_t k = 0; k < fg_part_count(foil, m->owner); k++)
      add_object(m, fg_part_at(foil, m->owner, k).object, &parts);
    add_parts(m, &parts, &foils);
  }
  mean discs = {0};
  for (size_t i = 0; m->owner == FG_QUANTITY_OF_DISC && i < measurement->disc_count; i++)
    add_object(m, &measurement->discs[i], &discs);
  add_parts(m, &discs, &foils);
  if (!foils.count) return;
  scan->value = foils.sum / (double)foils.count;
  scan->u = sqrt(foils.squares) / (double)foils.count;
}

/* Mean over the parts of each foil, and over the foils. */
static double mean_move(const measuring *m, const fg_measurement *measurement, size_t source) {
  size_t at = fg_quantity_move_of(m->owner, m->row);
  mean foils = {0}, discs = {0};
  for (size_t i = 0; i < measurement->foil_count; i++) {
    const fg_foil *foil = &measurement->foils[i];
    mean parts = {0};
    if (m->owner == FG_QUANTITY_OF_FOIL && isfinite(fg_quantity_value(m->row, foil)))
      add_to_mean(&parts, foil->calibrated.move[source][at], 0);
    for (size_t k = 0; k < fg_part_count(foil, m->owner); k++) {
      const fg_foil_part part = fg_part_at(foil, m->owner, k);
      if (isfinite(fg_quantity_value(m->row, part.object)))
        add_to_mean(&parts, part.calibrated->move[source][at], 0);
    }
    if (parts.count) add_to_mean(&foils, parts.sum / (double)parts.count, 0);
  }
  for (size_t i = 0; m->owner == FG_QUANTITY_OF_DISC && i < measurement->disc_count; i++)
    add_to_mean(&discs, measurement->discs[i].calibrated.move[source][at], 0);
  if (discs.count) add_to_mean(&foils, discs.sum / (double)discs.count, 0);
  return foils.count ? foils.sum / (double)foils.count : 0;
}

static fg_status read_moves(fg_context *ctx, const measuring *m, fg_measurement *measurement,
                            fg_experiment_scan *scan) {
  if (!m->options->design->calibration.stated || !fg_quantity_has_u(m->row)) return FG_OK;
  FG_TRY(fg_measurement_calibrate(ctx, m->options->measure.threads, measurement));
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    scan->move[s] = mean_move(m, measurement, s);
  return FG_OK;
}

static fg_status describe_failure(fg_context *ctx, fg_experiment_scan *scan, const char *words) {
  char *text = NULL;
  FG_TRY(fg_text_print(ctx, &text, "%s", words));
  scan->error = text;
  return FG_OK;
}

static fg_status measure_scan(fg_context *ctx, const measuring *m, fg_experiment_scan *scan) {
  fg_measurement measurement = {0};
  fg_context words = {0};
  fg_status status =
      fg_measure_scan(&words, scan->path, m->options->design, &m->options->measure, &measurement);
  if (status == FG_ERR_MEMORY || status == FG_ERR_INTERRUPTED)
    return fg_fail(ctx, status, "%s", words.message);
  if (status != FG_OK) return describe_failure(ctx, scan, words.message);
  read_measurement(m, &measurement, scan);
  if (!isfinite(scan->value)) {
    snprintf(words.message, sizeof words.message, "%.400s: %s could not be measured%s%.400s",
             scan->path, m->options->quantity,
             measurement.foil_count && measurement.foils[0].error[0] ? ": " : "",
             measurement.foil_count ? measurement.foils[0].error : "");
    status = describe_failure(ctx, scan, words.message);
  } else {
    status = read_moves(ctx, m, &measurement, scan);
  }
  fg_measurement_free(&measurement);
  return status;
}

static fg_status scan_path(fg_context *ctx, const measuring *m, const char *name, size_t length,
                           char **path) {
  const char *folder = m->options->folder;
  bool relative = folder && *folder && *name != '/';
  return fg_text_print(ctx, path, "%s%s%.*s", relative ? folder : "", relative ? "/" : "",
                       (int)length, name);
}

/* Takes over `path`. */
static fg_status add_run_scan(fg_context *ctx, measuring *m, size_t run, char *path) {
  fg_run_sheet *out = m->out;
  fg_status status = fg_memory_reserve(ctx, out->scans + 1, sizeof *out->scan, &m->scan_capacity,
                                       (void **)&out->scan);
  if (status != FG_OK) {
    free(path);
    return status;
  }
  out->scan[out->scans++] = (fg_experiment_scan){.run = run, .path = path, .value = NAN, .u = NAN};
  return m->options->visit ? m->options->visit(ctx, m->options->user, path) : FG_OK;
}

static fg_status list_run(fg_context *ctx, measuring *m, size_t run, const char *cell) {
  for (const char *at = cell; *at;) {
    at += strspn(at, "; \t");
    size_t length = strcspn(at, ";");
    size_t end = length;
    while (end > 0 && (at[end - 1] == ' ' || at[end - 1] == '\t'))
      end--;
    char *path = NULL;
    if (end) FG_TRY(scan_path(ctx, m, at, end, &path));
    if (end) FG_TRY(add_run_scan(ctx, m, run, path));
    at += length;
  }
  return FG_OK;
}

static fg_status list_scans(fg_context *ctx, const fg_table *sheet, const fg_column *column,
                            measuring *m) {
  for (size_t i = 0; i < sheet->rows; i++) {
    size_t word = column->word ? column->word[i] : FG_TABLE_NOT_A_WORD;
    if (word == FG_TABLE_NOT_A_WORD)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: row %zu, column '%s': a number (%.15g) is no name of a scan",
                     sheet->source ? sheet->source : "the run sheet", i + 1, column->name,
                     column->number[i].value);
    if (word == FG_TABLE_MISSING)
      m->out->empty++;
    else
      FG_TRY(list_run(ctx, m, i + 1, column->words[word]));
  }
  return FG_OK;
}

/* Returns u of the mean of all runs by the calibration. All scans share its error, which moves
 * the mean by the mean of the runs' moves. */
static double level_calibration(const fg_run_sheet *sheet) {
  double squares = 0;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++) {
    mean all = {0};
    for (size_t i = 0; i < sheet->scans; i++)
      if (!sheet->scan[i].error) add_to_mean(&all, sheet->scan[i].move[s], 0);
    if (all.count) squares += pow(all.sum / (double)all.count, 2);
  }
  return sqrt(squares);
}

static fg_status measure_runs(fg_context *ctx, measuring *m) {
  fg_run_sheet *out = m->out;
  size_t kept = 0;
  for (size_t i = 0; i < out->scans;) {
    mean scans = {0};
    size_t run = out->scan[i].run;
    for (; i < out->scans && out->scan[i].run == run; i++) {
      FG_TRY(measure_scan(ctx, m, &out->scan[i]));
      out->failed += out->scan[i].error != NULL;
      add_to_mean(&scans, out->scan[i].value, out->scan[i].u);
    }
    if (!scans.count) continue;
    m->value[kept] = scans.sum / (double)scans.count;
    m->u[kept] = sqrt(scans.squares) / (double)scans.count;
    out->row[kept++] = run - 1;
  }
  out->table.rows = kept;
  out->u_calibration = level_calibration(out);
  return FG_OK;
}

static fg_status check_any(fg_context *ctx, const fg_table *sheet, const measuring *m) {
  if (m->out->table.rows) return FG_OK;
  for (size_t i = 0; i < m->out->scans; i++)
    if (m->out->scan[i].error)
      return fg_fail(ctx, FG_ERR_DATA, "not one of %zu scans could be measured; the first: %.800s",
                     m->out->scans, m->out->scan[i].error);
  return fg_fail(ctx, FG_ERR_DATA, "%s: column '%s' names no scan in any of %zu rows",
                 sheet->source ? sheet->source : "the run sheet", m->options->column, sheet->rows);
}

/* The rows that are kept, and the two new columns. */
static fg_status fill_table(fg_context *ctx, const fg_table *sheet, measuring *m) {
  fg_run_sheet *out = m->out;
  size_t kept = out->table.rows;
  char *u_name = NULL;
  bool has_u = true;
  out->table.rows = 0;
  FG_TRY(fg_table_select(ctx, sheet, out->row, kept, &out->table));
  for (size_t i = 0; i < kept; i++) {
    out->row[i]++;
    has_u = has_u && isfinite(m->u[i]);
  }
  FG_TRY(fg_table_add_numbers(ctx, &out->table, m->options->quantity, m->value, kept));
  if (!has_u) return FG_OK;
  FG_TRY(fg_text_print(ctx, &u_name, "u_%s", m->options->quantity));
  fg_status status = fg_table_add_numbers(ctx, &out->table, u_name, m->u, kept);
  free(u_name);
  return status;
}

static fg_status measure_sheet(fg_context *ctx, const fg_table *sheet, const fg_column *column,
                               measuring *m) {
  FG_TRY(list_scans(ctx, sheet, column, m));
  FG_TRY(measure_runs(ctx, m));
  FG_TRY(check_any(ctx, sheet, m));
  return fill_table(ctx, sheet, m);
}

fg_status fg_run_sheet_measure(fg_context *ctx, const fg_table *sheet,
                               const fg_run_sheet_options *options, fg_run_sheet *measured) {
  const fg_column *column = NULL, *there = NULL;
  fg_status status = FG_OK;
  measuring m = {.options = options, .out = measured};
  *measured = (fg_run_sheet){0};
  FG_TRY(fg_table_find(ctx, sheet, options->column, &column));
  FG_TRY(find_quantity(ctx, &m));
  if (fg_table_find(NULL, sheet, options->quantity, &there) == FG_OK)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: there is a column '%s' already: either measure (--scans) or take the "
                   "column, and rename it to do both",
                   sheet->source ? sheet->source : "the run sheet", options->quantity);
  FG_TRY_EXIT(fg_memory_allocate(ctx, sheet->rows, sizeof *m.value, (void **)&m.value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, sheet->rows, sizeof *m.u, (void **)&m.u));
  FG_TRY_EXIT(fg_memory_allocate(ctx, sheet->rows, sizeof *measured->row, (void **)&measured->row));
  FG_TRY_EXIT(measure_sheet(ctx, sheet, column, &m));
exit:
  free(m.value);
  free(m.u);
  if (status != FG_OK) fg_run_sheet_free(measured);
  return status;
}

void fg_run_sheet_free(fg_run_sheet *measured) {
  if (!measured) return;
  for (size_t i = 0; i < measured->scans; i++) {
    free((char *)measured->scan[i].path);
    free((char *)measured->scan[i].error);
  }
  free(measured->scan);
  free(measured->row);
  fg_table_free(&measured->table);
  *measured = (fg_run_sheet){0};
}
