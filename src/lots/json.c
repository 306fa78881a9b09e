/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON of the index, "schema": "foilgauge/lot_index/1" (reports/schema/lot_index.schema.json), and
 * its table: a line for each lot and quantity. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "lots/index.h"
#include "report/measure/json.h"

/* Limit of the listed pairs, those that differ most; `tested` and `differing` count all. */
enum { PAIRS_LISTED_MAX = 2000 };

static const char *scale_word(fg_index_scale scale) {
  static const char *const words[] = {"as_is", "over_design", "apart"};
  return words[scale];
}

static void write_index_date(fg_json *json, const fg_lot_date *date) {
  fg_json_object(json, "date");
  fg_json_line(json);
  fg_json_string(json, "first", date->from ? date->first : NULL);
  fg_json_string(json, "last", date->from ? date->last : NULL);
  fg_json_string(json, "from", date->from);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_lot_counts(fg_json *json, const fg_index_lot *lot) {
  fg_json_object(json, "counts");
  fg_json_line(json);
  fg_json_integer(json, "scans", (int64_t)lot->scans);
  fg_json_integer(json, "scans_not_measured", (int64_t)lot->failed_scans);
  fg_json_integer(json, "foils", (int64_t)lot->foils);
  for (int verdict = FG_VERDICT_PASS; verdict <= FG_VERDICT_NONE; verdict++)
    fg_json_integer(json, fg_verdict_word((fg_verdict)verdict), (int64_t)lot->by_verdict[verdict]);
  fg_json_integer(json, "exceeded", (int64_t)lot->exceeded);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_spread(fg_json *json, const fg_index_spread *spread) {
  fg_json_object(json, "radius_over_design");
  fg_json_line(json);
  fg_json_integer(json, "count", (int64_t)spread->count);
  fg_json_number(json, "mean", spread->mean);
  fg_json_number(json, "mode", spread->mode);
  fg_json_number(json, "relative_sd_pct", spread->relative_sd_pct);
  fg_json_number(json, "min", spread->min);
  fg_json_number(json, "max", spread->max);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_stat(fg_json *json, const fg_index_stat *stat) {
  fg_json_object(json, stat->row->name);
  fg_json_line(json);
  fg_json_integer(json, "count", (int64_t)stat->count);
  fg_json_number(json, "mean", stat->mean);
  fg_json_number(json, "sd", stat->sd);
  fg_json_number(json, "min", stat->min);
  fg_json_number(json, "max", stat->max);
  fg_json_number(json, "tolerance_min", stat->lower);
  fg_json_number(json, "tolerance_max", stat->upper);
  fg_json_integer(json, "foils", (int64_t)stat->foils);
  fg_json_number(json, "foil_mean", stat->foil_mean);
  fg_json_number(json, "foil_sd", stat->foil_sd);
  fg_json_number(json, "expected_low", stat->expected_low);
  fg_json_number(json, "expected_high", stat->expected_high);
  fg_json_bool(json, "unexpected", stat->unexpected);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_read_lot(fg_json *json, const fg_index *index, const fg_index_lot *lot,
                           const char *dies) {
  fg_json_string(json, "name", lot->name);
  write_index_date(json, &lot->date);
  fg_json_string(json, "version", lot->version);
  fg_json_verdict(json, lot->verdict);
  write_lot_counts(json, lot);
  fg_json_string(json, "dies", dies);
  fg_json_string(json, "coils", lot->coils);
  fg_json_string(json, "design_name", lot->design.name);
  fg_json_integer(json, "design_number", (int64_t)lot->design_number);
  fg_json_string(json, "foils_unknown", lot->foils_unknown);
  write_spread(json, &lot->spread);
  fg_json_object(json, "quantities");
  for (size_t i = 0; i < index->axis_count; i++) {
    const fg_index_stat *stat = fg_index_stat_of(&index->axes[i], lot);
    if (stat) write_stat(json, stat);
  }
  fg_json_object_end(json);
}

static fg_status write_index_lot(fg_context *ctx, fg_json *json, const fg_index *index,
                                 const fg_index_lot *lot) {
  char *dies = NULL;
  FG_TRY(fg_index_die_names(ctx, index, lot, &dies));
  fg_json_object(json, NULL);
  fg_json_string(json, "folder", lot->folder);
  fg_json_string(json, "sha256", lot->sha256[0] ? lot->sha256 : NULL);
  fg_json_string(json, "problem", lot->problem);
  if (!lot->problem) write_read_lot(json, index, lot, dies);
  fg_json_object_end(json);
  free(dies);
  return FG_OK;
}

static void write_index_axis(fg_json *json, const fg_index *index, const fg_index_axis *axis) {
  bool same = axis->same_as != FG_INDEX_NONE;
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "name", axis->row->name);
  fg_json_string(json, "scale", scale_word(axis->scale));
  fg_json_string(json, "same_as", same ? index->axes[axis->same_as].row->name : NULL);
  fg_json_integer(json, "lots", (int64_t)axis->lots);
  fg_json_number(json, "centre", axis->between.centre);
  fg_json_number(json, "u_centre", axis->between.u_centre);
  fg_json_number(json, "between_sd", axis->between.sd);
  fg_json_number(json, "between_sd_low", axis->between.sd_low);
  fg_json_number(json, "between_sd_high", axis->between.sd_high);
  fg_json_number(json, "within_sd", axis->within_sd);
  fg_json_number(json, "p_equal", axis->p_equal);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

/* Writes the members that pairs of lots and of dies share. */
static void write_pair(fg_json *json, const fg_index *index, const fg_index_pair *pair,
                       const char *a, const char *b) {
  fg_json_string(json, "quantity", index->axes[pair->axis].row->name);
  fg_json_string(json, "scale", scale_word(index->axes[pair->axis].scale));
  fg_json_string(json, "larger", a);
  fg_json_string(json, "smaller", b);
  fg_json_integer(json, "foils_larger", (int64_t)pair->foils_a);
  fg_json_integer(json, "foils_smaller", (int64_t)pair->foils_b);
  fg_json_number(json, "difference", pair->difference);
  fg_json_number(json, "u_difference", pair->u);
  fg_json_number(json, "freedom", pair->dof);
  fg_json_number(json, "low", pair->low);
  fg_json_number(json, "high", pair->high);
  fg_json_number(json, "p", pair->p);
  fg_json_number(json, "p_holm", pair->p_holm);
  fg_json_bool(json, "differs", pair->p_holm < 1 - FG_INDEX_CONFIDENCE);
}

static void write_pairs(fg_json *json, const fg_index *index) {
  size_t listed = index->pair_count < PAIRS_LISTED_MAX ? index->pair_count : PAIRS_LISTED_MAX;
  fg_json_object(json, "comparisons");
  fg_json_integer(json, "tested", (int64_t)index->pair_count);
  fg_json_integer(json, "differing", (int64_t)index->differing);
  fg_json_number(json, "confidence", FG_INDEX_CONFIDENCE);
  fg_json_array(json, "pairs");
  for (size_t i = 0; i < listed; i++) {
    const fg_index_pair *pair = &index->pairs[i];
    fg_json_object(json, NULL);
    fg_json_line(json);
    write_pair(json, index, pair, index->lots[pair->a].folder, index->lots[pair->b].folder);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_dies(fg_json *json, const fg_index *index) {
  static const char *const basis[] = {"within_lots", "between_lots", "not_separable"};
  fg_json_array(json, "dies");
  for (size_t i = 0; i < index->die_count; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "name", index->dies[i].name);
    fg_json_integer(json, "foils", (int64_t)index->dies[i].foils);
    fg_json_integer(json, "lots", (int64_t)index->dies[i].lots);
    write_spread(json, &index->dies[i].spread);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_array(json, "die_comparisons");
  for (size_t i = 0; i < index->die_pair_count; i++) {
    const fg_index_pair *pair = &index->die_pairs[i].pair;
    fg_json_object(json, NULL);
    fg_json_line(json);
    write_pair(json, index, pair, index->dies[pair->a].name, index->dies[pair->b].name);
    fg_json_string(json, "basis", basis[index->die_pairs[i].basis]);
    fg_json_integer(json, "lots", (int64_t)index->die_pairs[i].lots);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_lines(fg_json *json, const char *text) {
  fg_json_array(json, "notes");
  while (text && *text) {
    char line[1200];
    size_t length = strcspn(text, "\n");
    snprintf(line, sizeof line, "%.*s", (int)length, text);
    fg_json_string(json, NULL, line);
    text += length + (text[length] == '\n');
  }
  fg_json_array_end(json);
}

fg_status fg_index_write_json(fg_context *ctx, const fg_index *index, FILE *out) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/lot_index/1");
  fg_json_array(&json, "summary");
  for (size_t i = 0; i < index->sentence_count; i++)
    fg_json_string(&json, NULL, index->sentences[i]);
  fg_json_array_end(&json);
  fg_json_integer(&json, "lots_read", (int64_t)index->read);
  fg_json_integer(&json, "lots_not_read", (int64_t)(index->count - index->read));
  fg_json_integer(&json, "designs", (int64_t)index->designs);
  fg_json_array(&json, "lots");
  for (size_t i = 0; i < index->count; i++)
    FG_TRY(write_index_lot(ctx, &json, index, &index->lots[i]));
  fg_json_array_end(&json);
  fg_json_array(&json, "quantities");
  for (size_t i = 0; i < index->axis_count; i++)
    write_index_axis(&json, index, &index->axes[i]);
  fg_json_array_end(&json);
  write_pairs(&json, index);
  write_dies(&json, index);
  write_lines(&json, index->notes);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the index of lots");
}

static void put_quantity_line(FILE *out, const fg_index *index, const fg_index_lot *lot,
                              const fg_index_axis *axis, const fg_index_stat *stat) {
  const double numbers[] = {stat->mean,         stat->sd,           stat->min,       stat->max,
                            stat->lower,        stat->upper,        stat->foil_mean, stat->foil_sd,
                            stat->expected_low, stat->expected_high};
  fprintf(out, "%zu,", fg_index_number(index, lot));
  fg_csv_put_text(out, lot->folder, fg_utf8_put);
  fputc(',', out);
  fg_csv_put_text(out, lot->name, fg_utf8_put);
  fprintf(out, ",%s,%s,%zu,%s,%s,%zu,%zu", lot->date.first, fg_verdict_word(lot->verdict),
          lot->design_number, axis->row->name, scale_word(axis->scale), stat->count, stat->foils);
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    fg_csv_put_number(out, numbers[i]);
  fputc('\n', out);
}

fg_status fg_index_write_csv(fg_context *ctx, const fg_index *index, FILE *out) {
  fputs("lot,folder,name,date,verdict,design,quantity,scale,count,foils,mean,sd,min,max,"
        "tolerance_min,tolerance_max,foil_mean,foil_sd,expected_low,expected_high\n",
        out);
  for (size_t i = 0; i < index->read; i++)
    for (size_t k = 0; k < index->axis_count; k++) {
      const fg_index_stat *stat = fg_index_stat_of(&index->axes[k], &index->lots[i]);
      if (stat) put_quantity_line(out, index, &index->lots[i], &index->axes[k], stat);
    }
  return fg_stream_finish(ctx, out, "the table of lots");
}
