/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foils.csv, bumps.csv or beams.csv, bearings.csv: the manifest's columns first, so that any
 * program can pivot by them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/words.h"
#include "lot/statistics/dies.h"
#include "quantity/quantity_rows.h"
#include "report/flag_names.h"
#include "report/lot/files.h"

static void put_csv_text(FILE *out, const char *text) {
  fg_csv_put_text(out, text, fg_utf8_put);
}

static void put_manifest_cells(FILE *out, const fg_manifest *manifest, size_t item) {
  for (size_t i = 0; i < manifest->columns; i++) {
    if (i) fputc(',', out);
    put_csv_text(out, fg_manifest_cell(manifest, item, i));
  }
}

static void put_csv_heading(FILE *out, const fg_manifest *manifest, const char *more,
                            fg_quantity_owner owner) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < manifest->columns; i++) {
    if (i) fputc(',', out);
    put_csv_text(out, manifest->name[i]);
  }
  fputs(more, out);
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
  for (size_t i = 0; i < rows; i++)
    if (row[i].kind != FG_QUANTITY_PAIR) fputs(fg_quantity_has_u(&row[i]) ? ",," : ",", out);
  fputc('\n', out);
}

fg_status fg_lot_write_foils_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  const fg_lot *lot = analysis->lot;
  size_t next = 0;
  put_csv_heading(out, &lot->manifest, ",foil_number,page,verdict,flags,error",
                  FG_QUANTITY_OF_FOIL);
  for (size_t item = 0; item < lot->manifest.items; item++) {
    if (lot->records[item].error) put_failed_scan(out, lot, item);
    for (; next < analysis->foil_count && analysis->foils[next].item == item; next++) {
      const fg_lot_foil *foil = &analysis->foils[next];
      put_manifest_cells(out, &lot->manifest, item);
      fprintf(out, ",%d,", foil->foil->number);
      if (analysis->pages && analysis->pages[item]) put_csv_text(out, analysis->pages[item]);
      fprintf(out, ",%s", fg_verdict_word(foil->verdict));
      fg_csv_put_flags(out, fg_foil_flag_words(), foil->foil->flags,
                       foil->foil->strip.picture.findings);
      fputc(',', out);
      put_csv_text(out, foil->foil->error);
      put_quantity_cells(out, FG_QUANTITY_OF_FOIL, foil->foil);
    }
  }
  return fg_stream_finish(ctx, out, "foils.csv");
}

static void put_to_die(FILE *out, const fg_lot *lot, const fg_lot_foil *foil, const fg_bump *bump) {
  fg_lot_to_die to = fg_lot_bump_to_die(lot, foil, bump);
  fg_csv_put_number(out, to.radius_mm);
  fg_csv_put_number(out, to.error_pct);
  fg_csv_put_number(out, to.u_error_pct);
}

fg_status fg_lot_write_bumps_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  const fg_design *design = &analysis->lot->settings.design;
  const double *stiffness = analysis->stiffness.normalised;
  size_t at = 0;
  bool dies = analysis->lot->settings.die_count > 0;
  put_csv_heading(out, manifest,
                  dies ? ",foil_number,bump,flags,normalised_stiffness,die_radius_mm,"
                         "radius_error_to_die_pct,u_radius_error_to_die_pct,verdict"
                       : ",foil_number,bump,flags,normalised_stiffness,verdict",
                  FG_QUANTITY_OF_BUMP);
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    for (size_t k = 0; k < foil->foil->bump_count; k++) {
      const fg_bump *bump = &foil->foil->bumps[k];
      put_manifest_cells(out, manifest, foil->item);
      fprintf(out, ",%d,%d", foil->foil->number, bump->number);
      fg_csv_put_flags(out, fg_bump_flag_words(), fg_bump_flags(design, foil->foil, bump), 0);
      fg_csv_put_number(out, stiffness[at++]);
      if (dies) put_to_die(out, analysis->lot, foil, bump);
      fprintf(out, ",%s", fg_verdict_word(fg_bump_verdict(design, foil->foil, bump)));
      put_quantity_cells(out, FG_QUANTITY_OF_BUMP, bump);
    }
  }
  return fg_stream_finish(ctx, out, "bumps.csv");
}

fg_status fg_lot_write_beams_csv(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  const fg_design *design = &analysis->lot->settings.design;
  put_csv_heading(out, manifest, ",foil_number,beam,flags,verdict", FG_QUANTITY_OF_BEAM);
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    for (size_t k = 0; k < foil->beam_count; k++) {
      const fg_beam *beam = &foil->beams[k];
      put_manifest_cells(out, manifest, analysis->foils[i].item);
      fprintf(out, ",%d,%d", foil->number, beam->number);
      fg_csv_put_flags(out, fg_beam_flag_words(), fg_beam_flags(design, foil, beam), 0);
      fprintf(out, ",%s", fg_verdict_word(fg_beam_verdict(design, foil, beam)));
      put_quantity_cells(out, FG_QUANTITY_OF_BEAM, beam);
    }
  }
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
  FILE *words = open_memstream(&text, &size);
  if (!words) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: bearings.csv");
  for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
    const fg_lot_foil *foil = bearing->pad[pad];
    fprintf(words, "%s%s", pad ? " " : "",
            foil ? fg_manifest_label(&analysis->lot->manifest, foil->item) : "-");
    if (foil && analysis->lot->records[foil->item].foil_count > 1)
      fprintf(words, "#%d", foil->foil->number);
  }
  bool broken = fclose(words) != 0;
  if (!broken) put_csv_text(out, text);
  free(text);
  return broken ? fg_fail(ctx, FG_ERR_MEMORY, "out of memory: bearings.csv") : FG_OK;
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
