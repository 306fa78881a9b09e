/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foils.csv, bumps.csv or beams.csv, bearings.csv: the manifest's columns first, so that any
 * program can pivot by them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "lot/statistics/dies.h"
#include "quantity/quantity_rows.h"
#include "report/flag_names.h"
#include "report/lot/files.h"
#include "report/lot/members.h"
#include "report/verdict_members.h"

static void put_csv_text(FILE *out, const char *text) {
  fg_csv_put_text(out, text, fg_utf8_put);
}

static void put_manifest_cells(FILE *out, const fg_manifest *manifest, size_t item) {
  for (size_t i = 0; i < manifest->columns; i++) {
    if (i) fputc(',', out);
    put_csv_text(out, fg_manifest_cell(manifest, item, i));
  }
}

/* Finds the columns between the manifest's and the quantities'. */
static void find_middle_columns(const fg_members *members, const fg_lot_analysis *analysis,
                                fg_member_columns *columns) {
  const fg_subject list = {.object = analysis, .whole = analysis};
  size_t count = 0;
  fg_member_columns_of(members, FG_ON_CSV, &list, columns);
  for (size_t i = 0; i < columns->count; i++)
    if (!columns->rows[i]->column || columns->rows[i]->column(&list))
      columns->rows[count++] = columns->rows[i];
  columns->count = count;
}

static void put_csv_heading(FILE *out, const fg_manifest *manifest,
                            const fg_member_columns *columns, fg_quantity_owner owner) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < manifest->columns; i++) {
    if (i) fputc(',', out);
    put_csv_text(out, manifest->name[i]);
  }
  fputc(',', out);
  fg_members_csv_heading(out, columns);
  for (size_t i = 0; i < count; i++) {
    if (rows[i].kind == FG_QUANTITY_PAIR) continue;
    fprintf(out, ",%s", rows[i].name);
    if (!fg_quantity_has_u(&rows[i])) continue;
    const char *dot = strrchr(rows[i].name, '.');
    int group = dot ? (int)(dot - rows[i].name) + 1 : 0;
    fprintf(out, ",%.*su_%s", group, rows[i].name, rows[i].name + group);
  }
  fputc('\n', out);
}

static void put_quantity_cells(FILE *out, fg_quantity_owner owner, const void *object) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    if (rows[i].kind == FG_QUANTITY_PAIR) continue;
    size_t width = fg_quantity_numbers(&rows[i], object, numbers);
    for (size_t k = 0; k < width; k++)
      fg_csv_put_number(out, numbers[k]);
  }
  fputc('\n', out);
}

/* Puts every cell of the heading, empty ones too: readers count them. */
static void put_failed_scan(FILE *out, const fg_lot *lot, size_t item) {
  size_t rows;
  const fg_quantity *row = fg_quantities(FG_QUANTITY_OF_FOIL, &rows);
  put_manifest_cells(out, &lot->manifest, item);
  fprintf(out, ",,,not_measured,%s,", lot->records[item].repeat_of ? "repeated_scan" : "");
  put_csv_text(out, lot->records[item].error);
  fprintf(out, ",%s", fg_traceability_cells[fg_design_traceability_cell(&lot->settings.design)]);
  for (size_t i = 0; i < rows; i++)
    if (row[i].kind != FG_QUANTITY_PAIR) fputs(fg_quantity_has_u(&row[i]) ? ",," : ",", out);
  fputc('\n', out);
}

fg_status fg_lot_write_foils_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  const fg_lot *lot = analysis->lot;
  size_t next = 0;
  fg_member_columns columns;
  find_middle_columns(&fg_lot_foil_members, analysis, &columns);
  put_csv_heading(out, &lot->manifest, &columns, FG_QUANTITY_OF_FOIL);
  for (size_t item = 0; item < lot->manifest.items; item++) {
    if (lot->records[item].error) put_failed_scan(out, lot, item);
    for (; next < analysis->foil_count && analysis->foils[next].item == item; next++) {
      const fg_lot_foil *foil = &analysis->foils[next];
      put_manifest_cells(out, &lot->manifest, item);
      fputc(',', out);
      fg_members_csv_cells(out, &columns, &(fg_subject){.object = foil, .whole = analysis});
      put_quantity_cells(out, FG_QUANTITY_OF_FOIL, foil->foil);
    }
  }
  return fg_stream_finish(ctx, out, "foils.csv");
}

/* A bump or beam of the lot, as a line of its table. */
typedef struct part_line {
  const fg_lot_foil *foil;
  fg_foil_part part;
  char flags[1000];
  fg_verdict verdict;
  double stiffness; /* of a bump, over the design's */
  fg_lot_to_die to_die;
} part_line;

static void find_part_line(const fg_lot_analysis *analysis, const fg_lot_foil *foil, size_t k,
                           part_line *line) {
  const fg_design *design = &analysis->lot->settings.design;
  bool beam = analysis->parts == FG_QUANTITY_OF_BEAM;
  line->foil = foil;
  line->part = fg_part_at(foil->foil, analysis->parts, k);
  const void *part = line->part.object;
  unsigned flags =
      beam ? fg_beam_flags(design, foil->foil, part) : fg_bump_flags(design, foil->foil, part);
  fg_flag_names(beam ? fg_beam_flag_words() : fg_bump_flag_words(), flags, 0, line->flags,
                sizeof line->flags);
  line->verdict =
      beam ? fg_beam_verdict(design, foil->foil, part) : fg_bump_verdict(design, foil->foil, part);
  if (!beam) line->to_die = fg_lot_bump_to_die(analysis->lot, foil, part);
}

static double find_part_foil(const fg_subject *subject) {
  return ((const part_line *)subject->object)->foil->foil->number;
}

static bool lot_has_dies(const fg_subject *list) {
  return ((const fg_lot_analysis *)list->whole)->lot->settings.die_count > 0;
}

static const fg_member part_rows[] = {
    {FG_COUNT_BY("foil_number", find_part_foil), .csv = {.rank = 1}},
    {FG_INTEGER("bump", part_line, part.number), .csv = {.rank = 1}, .column = fg_lot_has_no_beams},
    {FG_INTEGER("beam", part_line, part.number), .csv = {.rank = 1}, .column = fg_lot_has_beams},
    {FG_TEXT("flags", part_line, flags), .csv = {.rank = 1}},
    {FG_NUMBER("normalised_stiffness", part_line, stiffness), .csv = {.rank = 1},
     .column = fg_lot_has_no_beams},
    {FG_NUMBER("die_radius_mm", part_line, to_die.radius_mm), .csv = {.rank = 1},
     .column = lot_has_dies},
    {FG_NUMBER_U("radius_error_to_die_pct", part_line, to_die.error_pct, to_die.u_error_pct),
     .csv = {.rank = 1}, .column = lot_has_dies},
    {FG_WORD("verdict", part_line, verdict, fg_verdict_words), .csv = {.rank = 1}},
    {FG_WORD_BY("traceability", fg_lot_traceability, fg_traceability_cells), .csv = {.rank = 1}},
};
static const fg_members part_members = FG_MEMBERS(part_rows);

static void write_parts_csv(const fg_lot_analysis *analysis, FILE *out) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  const double *stiffness = analysis->stiffness.normalised;
  size_t at = 0;
  part_line line;
  fg_member_columns columns;
  find_middle_columns(&part_members, analysis, &columns);
  put_csv_heading(out, manifest, &columns, analysis->parts);
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    for (size_t k = 0; k < fg_part_count(foil->foil, analysis->parts); k++) {
      find_part_line(analysis, foil, k, &line);
      line.stiffness = stiffness ? stiffness[at++] : NAN;
      put_manifest_cells(out, manifest, foil->item);
      fputc(',', out);
      fg_members_csv_cells(out, &columns, &(fg_subject){.object = &line, .whole = analysis});
      put_quantity_cells(out, analysis->parts, line.part.object);
    }
  }
}

fg_status fg_lot_write_bumps_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  write_parts_csv(analysis, out);
  return fg_stream_finish(ctx, out, "bumps.csv");
}

fg_status fg_lot_write_beams_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  write_parts_csv(analysis, out);
  return fg_stream_finish(ctx, out, "beams.csv");
}

static void put_bearing_heading(FILE *out) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BEARING, &count);
  fputs("bearing,pads,verdict,places", out);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < fg_quantity_width(&rows[i]); k++) {
      char name[96];
      fg_quantity_column(&rows[i], k, name, sizeof name);
      fprintf(out, ",%s", name);
    }
  fputc('\n', out);
}

/* Puts the foils' labels separated by spaces, "-" for a missing pad. */
static fg_status put_pad_labels(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis,
                                const fg_lot_bearing *bearing) {
  char *text = NULL;
  size_t size;
  FILE *words = fg_stream_open(&text, &size);
  if (!words) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: bearings.csv");
  for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
    const fg_lot_foil *foil = bearing->pad[pad];
    fprintf(words, "%s%s", pad ? " " : "",
            foil ? fg_manifest_label(&analysis->lot->manifest, foil->item) : "-");
    if (foil && analysis->lot->records[foil->item].foil_count > 1)
      fprintf(words, "#%d", foil->foil->number);
  }
  if (!fg_stream_keep(words, &text))
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: bearings.csv");
  put_csv_text(out, text);
  free(text);
  return FG_OK;
}

fg_status fg_lot_write_bearings_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  size_t rows;
  const fg_quantity *row = fg_quantities(FG_QUANTITY_OF_BEARING, &rows);
  put_bearing_heading(out);
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    const fg_lot_bearing *bearing = &analysis->bearings[i];
    if (bearing->name)
      put_csv_text(out, bearing->name);
    else
      fprintf(out, "%zu", bearing->number);
    fputc(',', out);
    FG_TRY(put_pad_labels(ctx, out, analysis, bearing));
    fprintf(out, ",%s,%zu", fg_verdict_word(bearing->decision.outcome.verdict), bearing->places);
    for (size_t k = 0; k < rows; k++) {
      double numbers[FG_QUANTITY_NUMBERS_MAX];
      size_t width = fg_quantity_numbers(&row[k], &bearing->clearance, numbers);
      bool count = row[k].kind == FG_QUANTITY_COUNT;
      for (size_t n = 0; n < width; n++)
        fg_csv_put_number(out, bearing->known || count ? numbers[n] : NAN);
    }
    fputc('\n', out);
  }
  return fg_stream_finish(ctx, out, "bearings.csv");
}
