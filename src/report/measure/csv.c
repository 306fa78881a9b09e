/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comma-separated values, quoted as in RFC 4180, lines end with \n: bumps, and every edge point. */
#include <math.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "quantity/quantity_rows.h"
#include "report/flag_names.h"
#include "report/measure/foil_view.h"
#include "report/measure/grid_members.h"

static void put_names(FILE *out, const fg_quantity *quantity) {
  for (size_t k = 0; k < fg_quantity_width(quantity); k++) {
    char name[64];
    fg_quantity_column(quantity, k, name, sizeof name);
    fprintf(out, ",%s", name);
  }
}

static void put_values(FILE *out, fg_quantity_owner owner, const void *object) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    size_t width = fg_quantity_numbers(&rows[i], object, numbers);
    for (size_t k = 0; k < width; k++)
      fg_csv_put_number(out, numbers[k]);
  }
}

/* Cells that all lines of a scan share. */
typedef struct scan_lines {
  const char *path;
  const fg_design *design;
  const fg_measurement *measurement;
} scan_lines;

/* `foil` NULL: of a disc. */
static void put_end(FILE *out, const scan_lines *scan, fg_verdict verdict, const fg_foil *foil) {
  fprintf(out, ",%s,%s,%s", fg_verdict_word(verdict), scan->measurement->model_sha256,
          fg_traceability_cells[fg_design_traceability_cell(scan->design)]);
  for (int i = 0; foil && i < 4; i++)
    fg_csv_put_number(out, foil->place_mm[i]);
  fputc('\n', out);
}

/* Returns the flags of a line; those of the whole scan are in every line. */
static unsigned flags_of_line(const scan_lines *scan, const fg_foil *foil, const fg_bump *bump) {
  unsigned flags = fg_bump_flags(scan->design, foil, bump);
  return foil->flags & FG_FOIL_LOSSY ? flags | FG_BUMP_LOSSY : flags;
}

static void put_bump(FILE *out, const scan_lines *scan, const fg_foil *foil, const fg_bump *bump) {
  fg_csv_put_text(out, scan->path, NULL);
  fprintf(out, ",%d,%d", foil->number, bump->number);
  fg_csv_put_flags(out, fg_bump_flag_words(), flags_of_line(scan, foil, bump),
                   foil->strip.picture.findings);
  put_values(out, FG_QUANTITY_OF_BUMP, bump);
  put_end(out, scan, fg_bump_verdict(scan->design, foil, bump), foil);
}

static void put_beam(FILE *out, const scan_lines *scan, const fg_foil *foil, const fg_beam *beam) {
  fg_csv_put_text(out, scan->path, NULL);
  fprintf(out, ",%d,%d", foil->number, beam->number);
  fg_csv_put_flags(out, fg_beam_flag_words(), fg_beam_flags(scan->design, foil, beam),
                   foil->strip.picture.findings);
  put_values(out, FG_QUANTITY_OF_BEAM, beam);
  put_end(out, scan, fg_beam_verdict(scan->design, foil, beam), foil);
}

static size_t count_numbers(fg_quantity_owner owner) {
  size_t count, numbers = 0;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++)
    numbers += fg_quantity_width(&rows[i]);
  return numbers;
}

/* Writes a line with empty values for a foil without bumps, so that it is not left out. */
static void put_bare_foil(FILE *out, const scan_lines *scan, const fg_foil *foil) {
  fg_csv_put_text(out, scan->path, NULL);
  fprintf(out, ",%d,", foil->number);
  fg_csv_put_flags(out, fg_foil_flag_words(), foil->flags, foil->strip.picture.findings);
  for (size_t i = count_numbers(fg_foil_view_of(scan->design->kind)->lines); i-- > 0;)
    fputc(',', out);
  put_end(out, scan, FG_VERDICT_NOT_MEASURED, foil);
}

static fg_status put_disc(fg_context *ctx, FILE *out, const scan_lines *scan, const fg_disc *disc) {
  fg_decision decision;
  FG_TRY(fg_disc_decide(ctx, scan->design, disc, &decision));
  fg_csv_put_text(out, scan->path, NULL);
  fprintf(out, ",%d", disc->number);
  fg_csv_put_flags(out, fg_bump_flag_words(), fg_disc_flags(scan->design, disc),
                   disc->picture.findings);
  put_values(out, FG_QUANTITY_OF_DISC, disc);
  put_end(out, scan, decision.outcome.verdict, NULL);
  fg_decision_free(&decision);
  return FG_OK;
}

/* A line per foil, of one without parts. */
static fg_status put_whole_foil(fg_context *ctx, FILE *out, const scan_lines *scan,
                                const fg_foil *foil) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, scan->design, foil, &decision));
  fg_csv_put_text(out, scan->path, NULL);
  fprintf(out, ",%d", foil->number);
  fg_csv_put_flags(out, fg_foil_flag_words(), foil->flags, foil->strip.picture.findings);
  put_values(out, FG_QUANTITY_OF_FOIL, foil);
  put_end(out, scan, decision.outcome.verdict, foil);
  fg_decision_free(&decision);
  return FG_OK;
}

static void put_heading(FILE *out, fg_quantity_owner owner) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  fputs(owner == FG_QUANTITY_OF_BUMP   ? "scan,foil,bump,flags"
        : owner == FG_QUANTITY_OF_BEAM ? "scan,foil,beam,flags"
        : owner == FG_QUANTITY_OF_FOIL ? "scan,foil,flags"
                                       : "scan,disc,flags",
        out);
  for (size_t i = 0; i < count; i++)
    put_names(out, &rows[i]);
  fputs(",verdict,model_sha256,traceability", out);
  if (owner != FG_QUANTITY_OF_DISC) fputs(",foil_x_mm,foil_y_mm,foil_width_mm,foil_height_mm", out);
  fputc('\n', out);
}

static fg_status put_foil(fg_context *ctx, FILE *out, const scan_lines *scan, const fg_foil *foil) {
  if (fg_foil_view_of(scan->design->kind)->lines == FG_QUANTITY_OF_FOIL)
    return put_whole_foil(ctx, out, scan, foil);
  if (!foil->bump_count && !foil->beam_count) put_bare_foil(out, scan, foil);
  for (size_t b = 0; b < foil->bump_count; b++)
    put_bump(out, scan, foil, &foil->bumps[b]);
  for (size_t b = 0; b < foil->beam_count; b++)
    put_beam(out, scan, foil, &foil->beams[b]);
  return FG_OK;
}

fg_status fg_report_write_csv(fg_context *ctx, const fg_report *report, FILE *out) {
  put_heading(out, fg_foil_view_of(report->design->kind)->lines);
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_measurement *measurement = report->scans[i].measurement;
    const scan_lines scan = {report->scans[i].path, report->design, measurement};
    for (size_t k = 0; measurement && k < measurement->foil_count; k++)
      FG_TRY(put_foil(ctx, out, &scan, &measurement->foils[k]));
    for (size_t k = 0; measurement && k < measurement->disc_count; k++)
      FG_TRY(put_disc(ctx, out, &scan, &measurement->discs[k]));
  }
  return fg_stream_finish(ctx, out, "the CSV file");
}

typedef struct edge_point {
  const char *side;
  fg_point at;
  double u_um;
  double residual_um;
} edge_point;

/* Fixed digits: edge points are many, and nm are enough. */
static void put_fixed(FILE *out, double value) {
  fputc(',', out);
  if (isfinite(value)) fprintf(out, "%.4f", value);
}

static void put_point(FILE *out, const char *place, const fg_station *station,
                      const fg_station_label *label, const edge_point *point) {
  fprintf(out, "%s,%.6f,%s,%.6f,%.6f", place, station->s_mm, point->side, point->at.x, point->at.y);
  put_fixed(out, point->u_um);
  fprintf(out, ",%s,%d,%d", fg_arc_kind_word(label->kind), label->number, label->fitted);
  put_fixed(out, point->residual_um);
  fputc('\n', out);
}

static void put_station(FILE *out, const char *place, const fg_station *station,
                        const fg_station_label *label) {
  const edge_point points[] = {
      {"left", station->left, station->u_left_um, label->residual_left_um},
      {"mid",
       {(station->left.x + station->right.x) / 2, (station->left.y + station->right.y) / 2},
       hypot(station->u_left_um, station->u_right_um) / 2,
       label->residual_um},
      {"right", station->right, station->u_right_um, label->residual_right_um},
  };
  for (size_t i = 0; i < sizeof points / sizeof points[0]; i++)
    put_point(out, place, station, label, &points[i]);
}

/* Writes the points of a beam's edges. */
static void put_beam_points(FILE *out, size_t scan, const fg_foil *foil, const fg_beam *beam) {
  static const char *const sides[FG_BEAM_SIDES] = {"left", "right", "tip", "root_left",
                                                   "root_right"};
  for (int side = 0; side < FG_BEAM_SIDES; side++)
    for (size_t i = 0; i < beam->edges[side].count; i++) {
      const fg_disc_point *p = &beam->edges[side].stations[i];
      fprintf(out, "%zu,%d,%d,%s,%zu,%.6f,%.6f", scan, foil->number, beam->number, sides[side], i,
              p->at.x, p->at.y);
      put_fixed(out, 1000 * p->u);
      fprintf(out, ",%d\n", p->used);
    }
}

static void put_foil_points(FILE *out, size_t scan, const fg_foil *foil) {
  char place[80];
  for (size_t b = 0; b < foil->beam_count; b++)
    put_beam_points(out, scan, foil, &foil->beams[b]);
  for (size_t i = 0; foil->labels && i < foil->strip.count; i++) {
    snprintf(place, sizeof place, "%zu,%d,%zu", scan, foil->number, i);
    put_station(out, place, &foil->strip.stations[i], &foil->labels[i]);
  }
}

static void put_disc_points(FILE *out, size_t scan, const fg_disc *disc) {
  for (size_t i = 0; disc->edge && disc->residual_um && i < disc->points; i++) {
    fprintf(out, "%zu,%d,%zu,%.6f,%.6f", scan, disc->number, i, disc->edge[i].x, disc->edge[i].y);
    put_fixed(out, disc->residual_um[i]);
    fputc('\n', out);
  }
}

fg_status fg_report_write_points(fg_context *ctx, const fg_report *report, FILE *out) {
  fputs(fg_foil_view_of(report->design->kind)->points_heading, out);
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_measurement *measurement = report->scans[i].measurement;
    for (size_t k = 0; measurement && k < measurement->foil_count; k++)
      put_foil_points(out, i + 1, &measurement->foils[k]);
    for (size_t k = 0; measurement && k < measurement->disc_count; k++)
      put_disc_points(out, i + 1, &measurement->discs[k]);
    if (measurement && measurement->grid) fg_csv_grid_points(out, i + 1, measurement->grid);
  }
  return fg_stream_finish(ctx, out, "the file of points");
}
