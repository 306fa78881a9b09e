/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots over time and against each other: reads their reports, and writes page, JSON and table. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/file.h"
#include "lots/index.h"

enum { PAGE, JSON, TABLE, OUTPUTS };

/* Refuses outputs that would overwrite the lots' reports or the pages that they link to. */
static fg_status check_index_outputs(fg_context *ctx, const fg_lot_index_request *request) {
  static const char *const inputs[] = {"lot.json", "index.html", "foils.csv", "bumps.csv",
                                       "beams.csv"};
  enum { INPUTS = sizeof inputs / sizeof *inputs };
  const char *const outputs[OUTPUTS] = {request->page, request->json, request->csv};
  fg_overwrite overwrite = {0};
  fg_status status = fg_overwrite_begin(ctx, outputs, OUTPUTS, &overwrite);
  for (size_t i = 0; i < INPUTS * request->count && status == FG_OK; i++) {
    char *path;
    status = fg_lot_path(ctx, request->folders[i / INPUTS], inputs[i % INPUTS], &path);
    if (status != FG_OK) break;
    status = fg_overwrite_check(ctx, &overwrite, path, "a report of a lot");
    free(path);
  }
  fg_overwrite_free(&overwrite);
  return status;
}

/* Lists the folders; one that is named twice, under any spelling, is one lot. */
static fg_status list_lots(fg_context *ctx, const fg_lot_index_request *request, fg_index *index) {
  FG_TRY(fg_memory_allocate(ctx, request->count, sizeof *index->lots, (void **)&index->lots));
  for (size_t i = 0; i < request->count; i++) {
    const char *folder = request->folders[i], *first = NULL;
    for (size_t k = 0; k < index->count && !first; k++)
      if (fg_overwrite_is_same(index->lots[k].folder, folder)) first = index->lots[k].folder;
    if (!first) {
      index->lots[index->count++].folder = folder;
      continue;
    }
    index->doubles++;
    FG_TRY(fg_text_append(ctx, &index->notes, "%s: the same folder as %s, counts once\n", folder,
                          first));
  }
  return FG_OK;
}

static fg_status read_lots(fg_context *ctx, fg_index *index) {
  for (size_t i = 0; i < index->count; i++) {
    fg_index_lot *lot = &index->lots[i];
    FG_TRY(fg_index_read_lot(ctx, lot));
    if (lot->problem) continue;
    FG_TRY(fg_index_read_foils(ctx, index, lot));
    FG_TRY(fg_index_read_prediction(ctx, lot));
    if (lot->foils_unknown)
      FG_TRY(fg_text_append(ctx, &index->notes,
                            "%s; without them there is no density and no test of this lot\n",
                            lot->foils_unknown));
    if (!lot->date.from)
      FG_TRY(fg_text_append(ctx, &index->notes,
                            "%s: the lot has no date and stands behind those that have one; give "
                            "its manifest a column `date` (2026-11-20) and write the report again "
                            "with --resume\n",
                            lot->folder));
  }
  return FG_OK;
}

static fg_status make_index(fg_context *ctx, const fg_lot_index_request *request, fg_index *index) {
  index->page = request->page;
  FG_TRY(list_lots(ctx, request, index));
  FG_TRY(read_lots(ctx, index));
  FG_TRY(fg_index_arrange(ctx, index));
  if (!index->read) return fg_fail(ctx, FG_ERR_DATA, "%s", index->lots[0].problem);
  FG_TRY(fg_index_spreads(ctx, index));
  FG_TRY(fg_index_compare(ctx, index));
  FG_TRY(fg_index_compare_dies(ctx, index));
  FG_TRY(fg_index_name_dies(ctx, index));
  return fg_index_make_sentences(ctx, index);
}

static fg_status write_csv(fg_context *ctx, void *index, FILE *out) {
  return fg_index_write_csv(ctx, index, out);
}

static fg_status write_index_output(fg_context *ctx, const fg_lot_index_request *request,
                                    fg_index *index, int kind, FILE *out) {
  if (kind == PAGE) return fg_index_write_page(ctx, index, out);
  return kind == JSON ? fg_index_write_json(ctx, index, out)
                      : fg_csv_write(ctx, request->decimal_comma, write_csv, index, out);
}

/* Writes and flushes all outputs before one gets its name: either all appear or none. */
static fg_status write_outputs(fg_context *ctx, const fg_lot_index_request *request,
                               fg_index *index) {
  const char *const path[OUTPUTS] = {request->page, request->json, request->csv};
  fg_output output[OUTPUTS];
  int opened = 0;
  fg_status status = FG_OK;
  for (; opened < OUTPUTS && status == FG_OK; opened++)
    if (path[opened]) status = fg_output_open(ctx, path[opened], &output[opened]);
  if (status != FG_OK) opened--; /* the last one is not open */
  for (int i = 0; i < OUTPUTS && status == FG_OK; i++)
    if (path[i]) {
      status = write_index_output(ctx, request, index, i, output[i].stream);
      status = fg_output_flush(ctx, &output[i], status);
    }
  for (int i = 0; i < opened; i++)
    if (path[i]) status = fg_output_end(ctx, &output[i], status);
  return status;
}

/* Fills the outcome: lots that could not be read, notes, sentences. */
static fg_status fill_index_outcome(fg_context *ctx, const fg_index *index,
                                    fg_lot_index_outcome *outcome) {
  outcome->lots = index->read;
  outcome->not_read = index->count - index->read;
  outcome->differing = index->differing;
  for (size_t i = index->read; i < index->count; i++)
    FG_TRY(fg_text_append(ctx, &outcome->notes, "%s\n", index->lots[i].problem));
  if (index->notes) FG_TRY(fg_text_append(ctx, &outcome->notes, "%s", index->notes));
  for (size_t i = 0; i < index->sentence_count; i++)
    FG_TRY(fg_text_append(ctx, &outcome->summary, "%s\n", index->sentences[i]));
  return FG_OK;
}

fg_status fg_lot_index(fg_context *ctx, const fg_lot_index_request *request,
                       fg_lot_index_outcome *outcome) {
  fg_index index = {0};
  fg_status status = FG_OK;
  *outcome = (fg_lot_index_outcome){0};
  FG_TRY_EXIT(check_index_outputs(ctx, request));
  FG_TRY_EXIT(make_index(ctx, request, &index));
  FG_TRY_EXIT(fill_index_outcome(ctx, &index, outcome));
  FG_TRY_EXIT(write_outputs(ctx, request, &index));
exit:
  if (status != FG_OK) fg_lot_index_outcome_free(outcome);
  fg_index_free(&index);
  return status;
}

void fg_lot_index_outcome_free(fg_lot_index_outcome *outcome) {
  free(outcome->notes);
  free(outcome->summary);
  *outcome = (fg_lot_index_outcome){0};
}
