/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the files of a report. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/parallel.h"
#include "core/text.h"
#include "film/lot_film.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"
#include "lot/run/date.h"
#include "report/lot/files.h"
#include "report/lot/foil_pages.h"

/* Lots that have a file. */
typedef enum lot_kind { ALL, CURVED, FLAT } lot_kind;

static const struct {
  const char *name;
  fg_lot_writer *write;
  lot_kind of;
} files[] = {
    {"bumps.csv", fg_lot_write_bumps_csv, CURVED},
    {"beams.csv", fg_lot_write_beams_csv, FLAT},
    {"foils.csv", fg_lot_write_foils_csv, ALL},
    {"bearings.csv", fg_lot_write_bearings_csv, CURVED},
    {"results.qif", fg_lot_write_qif, ALL},
    {"results.dfq", fg_lot_write_dfq, ALL},
    {"index.html", fg_lot_write_page, ALL},
    {"lot.json", fg_lot_write_json, ALL},
};

enum { FILES = sizeof files / sizeof files[0] };

typedef struct report_writing {
  const char *folder;
  const fg_lot_analysis *analysis;
  fg_output last; /* of the last of the files, which appears when all others are there */
} report_writing;

typedef struct file_writing {
  fg_lot_writer *write;
  const fg_lot_analysis *analysis;
} file_writing;

static fg_status write_report_stream(fg_context *ctx, void *user, FILE *out) {
  const file_writing *of = user;
  return of->write(ctx, of->analysis, out);
}

static bool is_csv(const char *name) {
  size_t length = strlen(name), tail = strlen(".csv");
  return length > tail && !strcmp(name + length - tail, ".csv");
}

static fg_status write_report_file(fg_context *ctx, void *shared, size_t i) {
  report_writing *w = shared;
  const fg_lot *lot = w->analysis->lot;
  file_writing of = {files[i].write, w->analysis};
  char *path;
  fg_output output;
  bool flat = fg_foil_traits_of(lot->settings.design.kind)->lies_flat;
  if (files[i].of == (flat ? CURVED : FLAT)) return FG_OK;
  FG_TRY(fg_lot_path(ctx, w->folder, files[i].name, &path));
  fg_status status = fg_output_open(ctx, path, &output);
  free(path);
  FG_TRY(status);
  status = fg_csv_write(ctx, is_csv(files[i].name) && lot->decimal_comma, write_report_stream, &of,
                        output.stream);
  if (i < FILES - 1 || status != FG_OK) return fg_output_end(ctx, &output, status);
  w->last = output;
  return FG_OK;
}

/* Writes the files beside each other: most of a large report's time is theirs. */
static fg_status write_report_files(fg_context *ctx, const char *folder,
                                    const fg_lot_analysis *analysis) {
  report_writing w = {.folder = folder, .analysis = analysis};
  fg_status status = fg_parallel_run(ctx, analysis->lot->threads, FILES, write_report_file, &w);
  if (!w.last.stream) return status;
  return fg_output_end(ctx, &w.last, status);
}

static fg_lot_verdicts list_verdicts(size_t count, const size_t *by_verdict) {
  fg_lot_verdicts verdicts = {.count = count};
  memcpy(verdicts.by_verdict, by_verdict, sizeof verdicts.by_verdict);
  return verdicts;
}

static void fill_lot_outcome(const fg_lot_analysis *analysis, fg_lot_outcome *outcome) {
  outcome->judged = analysis->outcome;
  outcome->scans.count = analysis->lot->manifest.items;
  outcome->scans.failed = analysis->failed_scans;
  outcome->notes.repeated = analysis->repeated;
  outcome->notes.invalid_dates = analysis->invalid_dates;
  outcome->exceeded = analysis->exceeded;
  outcome->foils = list_verdicts(analysis->foil_count, analysis->by_verdict);
  outcome->bearings = list_verdicts(analysis->bearing_count, analysis->bearings_by_verdict);
  fg_traceability_sentence(&analysis->lot->settings.design, outcome->traced,
                           sizeof outcome->traced);
  outcome->bearings_judged = fg_report_of_bearing(&analysis->lot->settings.design, NULL, 0) > 0;
  memcpy(outcome->assembly, analysis->assembly.statement, sizeof analysis->assembly.statement);
  if (outcome->assembly[0][0] && !analysis->assembly.why[0])
    fg_text_clip(outcome->assembly[3], sizeof outcome->assembly[3], "%s", fg_assembly_scope);
}

fg_status fg_lot_write_report(fg_context *ctx, const char *folder, const fg_lot *lot,
                              fg_lot_outcome *outcome) {
  fg_lot_analysis analysis;
  FG_TRY(fg_lot_analyse(ctx, lot, &analysis));
  analysis.folder = folder;
  char **pages = NULL;
  fg_status status = fg_lot_film_find(ctx, &analysis);
  if (status == FG_OK) status = fg_lot_pages_find(ctx, folder, lot, &pages);
  analysis.pages = pages;
  if (status == FG_OK) status = write_report_files(ctx, folder, &analysis);
  if (status == FG_OK) fill_lot_outcome(&analysis, outcome);
  fg_lot_pages_free(lot, pages);
  fg_lot_film_free(&analysis);
  fg_lot_analysis_free(&analysis);
  return status;
}
