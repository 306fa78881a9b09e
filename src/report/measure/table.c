/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The terminal's table: one block per foil, a row per bump, ± beside each value. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "core/utf8.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "quantity/quantity_rows.h"
#include "report/correction_words.h"
#include "report/measure/colour_lines_report.h"
#include "report/measure/foil_view.h"
#include "report/measure/gauge_report.h"
#include "report/measure/grid_members.h"
#include "report/measure/outcome_words.h"
#include "report/measure/picture_report.h"
#include "report/measure/scan_model_words.h"
#include "report/measure/thickness_budget.h"

enum { DECIMALS_FINE = 5, DECIMALS_MAX = 7 };

typedef struct column {
  const fg_quantity *row;
  int decimals;
  int width;   /* of the value */
  int u_width; /* of ±; 0 without */
} column;

typedef struct row_set {
  fg_quantity_owner owner;
  const char *objects; /* an array */
  size_t count, size;
} row_set;

/* Returns the decimals with which U = k u shows two digits; one digit, where the second would be
 * a nanometre or less. */
int fg_report_decimals(const fg_quantity *row, double u) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!(expanded > 0)) return row->decimals;
  int decimals = 1 - (int)floor(log10(expanded));
  if (decimals > DECIMALS_FINE) decimals = (int)fmax(DECIMALS_FINE, decimals - 1);
  if (decimals < row->decimals) return row->decimals;
  return decimals > DECIMALS_MAX ? DECIMALS_MAX : decimals;
}

static int text_width(const char *text) {
  return (int)fg_utf8_count(text);
}

static int number_width(double value, int decimals) {
  return isfinite(value) ? snprintf(NULL, 0, "%.*f", decimals, value) : 1;
}

/* U of a value that is known. */
static double expanded_of(const fg_quantity *row, const void *object) {
  if (!isfinite(fg_quantity_value(row, object))) return NAN;
  return FG_COVERAGE_FACTOR * fg_quantity_uncertainty(row, object);
}

static void measure_column(column *target, const row_set *rows) {
  const fg_quantity *row = target->row;
  double largest_u = 0;
  for (size_t i = 0; i < rows->count; i++) {
    double u = fg_quantity_uncertainty(row, rows->objects + i * rows->size);
    if (u > largest_u) largest_u = u;
  }
  target->decimals = row->kind == FG_QUANTITY_COUNT ? 0 : fg_report_decimals(row, largest_u);
  target->width = text_width(row->symbol);
  if (text_width(row->unit) > target->width) target->width = text_width(row->unit);
  target->u_width = row->u_offset == FG_NO_UNCERTAINTY ? 0 : 1;
  for (size_t i = 0; i < rows->count; i++) {
    const void *object = rows->objects + i * rows->size;
    int width = number_width(fg_quantity_value(row, object), target->decimals);
    if (width > target->width) target->width = width;
    width = number_width(expanded_of(row, object), target->decimals);
    if (target->u_width && width > target->u_width) target->u_width = width;
  }
}

static void put_padded(FILE *out, const char *text, int width) {
  fprintf(out, "%*s%s", width > text_width(text) ? width - text_width(text) : 0, "", text);
}

static void put_number(FILE *out, double value, int decimals, int width) {
  char text[64] = "-";
  if (isfinite(value)) snprintf(text, sizeof text, "%.*f", decimals, value);
  put_padded(out, text, width);
}

static void put_cells(FILE *out, const column *columns, size_t count, bool units) {
  for (size_t i = 0; i < count; i++) {
    fputs("  ", out);
    put_padded(out, units ? columns[i].row->unit : columns[i].row->symbol, columns[i].width);
    if (!columns[i].u_width) continue;
    fputc(' ', out);
    put_padded(out, units ? "" : "±", columns[i].u_width);
  }
  fputc('\n', out);
}

static void put_flags(FILE *out, const fg_flag_words *words, unsigned flags) {
  for (; words->name; words++)
    if (flags & words->flag) fprintf(out, "  %s", words->name);
}

static void put_findings(FILE *out, unsigned findings) {
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++)
    if (findings & found->finding) fprintf(out, "  %s", found->name);
}

static void put_row(FILE *out, const column *columns, size_t count, int number,
                    const void *object) {
  fprintf(out, "%4d", number);
  for (size_t i = 0; i < count; i++) {
    const column *at = &columns[i];
    fputs("  ", out);
    put_number(out, fg_quantity_value(at->row, object), at->decimals, at->width);
    if (!at->u_width) continue;
    fputc(' ', out);
    put_number(out, expanded_of(at->row, object), at->decimals, at->u_width);
  }
}

static size_t make_columns(const row_set *rows, fg_foil_kind kind, column *columns) {
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(rows->owner, FG_QUANTITY_ON_TERMINAL, kind, shown);
  for (size_t i = 0; i < count; i++) {
    columns[i].row = shown[i];
    measure_column(&columns[i], rows);
  }
  return count;
}

void fg_part_table_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil) {
  const row_set rows = {FG_QUANTITY_OF_BUMP, (const char *)foil->bumps, foil->bump_count,
                        sizeof *foil->bumps};
  column columns[FG_QUANTITY_SHOWN_MAX];
  size_t count = make_columns(&rows, design->kind, columns);
  fputs("bump", out);
  put_cells(out, columns, count, false);
  fputs("    ", out);
  put_cells(out, columns, count, true);
  for (size_t i = 0; i < foil->bump_count; i++) {
    put_row(out, columns, count, foil->bumps[i].number, &foil->bumps[i]);
    put_flags(out, fg_bump_flag_words(), fg_bump_flags(design, foil, &foil->bumps[i]));
    fputc('\n', out);
  }
}

void fg_part_table_of_beams(FILE *out, const fg_design *design, const fg_foil *foil) {
  const row_set rows = {FG_QUANTITY_OF_BEAM, (const char *)foil->beams, foil->beam_count,
                        sizeof *foil->beams};
  column columns[FG_QUANTITY_SHOWN_MAX];
  size_t count = make_columns(&rows, design->kind, columns);
  fputs("beam", out);
  put_cells(out, columns, count, false);
  fputs("    ", out);
  put_cells(out, columns, count, true);
  for (size_t i = 0; i < foil->beam_count; i++) {
    put_row(out, columns, count, foil->beams[i].number, &foil->beams[i]);
    put_flags(out, fg_beam_flag_words(), fg_beam_flags(design, foil, &foil->beams[i]));
    fputc('\n', out);
  }
}

static void put_discs(FILE *out, const fg_design *design, const fg_measurement *measurement) {
  const row_set rows = {FG_QUANTITY_OF_DISC, (const char *)measurement->discs,
                        measurement->disc_count, sizeof *measurement->discs};
  column columns[FG_QUANTITY_SHOWN_MAX];
  size_t count = make_columns(&rows, design->kind, columns);
  fputs("disc", out);
  put_cells(out, columns, count, false);
  fputs("    ", out);
  put_cells(out, columns, count, true);
  for (size_t i = 0; i < measurement->disc_count; i++) {
    put_row(out, columns, count, measurement->discs[i].number, &measurement->discs[i]);
    put_flags(out, fg_bump_flag_words(), fg_disc_flags(design, &measurement->discs[i]));
    put_findings(out, measurement->discs[i].picture.findings);
    fputc('\n', out);
  }
}

/* "overall radius 20.9500 ± 0.0012 mm" */
static void put_quantity(FILE *out, const fg_foil *foil, const fg_quantity *row) {
  double value = fg_quantity_value(row, foil), u = fg_quantity_uncertainty(row, foil);
  int decimals = fg_report_decimals(row, u);
  fprintf(out, "  %s ", row->words);
  put_number(out, value, decimals, 0);
  if (isfinite(u)) fprintf(out, " ± %.*f", decimals, FG_COVERAGE_FACTOR * u);
  fprintf(out, " %s\n", row->unit);
}

static void put_foil_flags(FILE *out, unsigned flags) {
  for (const fg_flag_words *words = fg_foil_flag_words(); words->name; words++)
    if (flags & words->flag) fprintf(out, "  %s: %s\n", words->name, words->plain);
}

static void put_correction(FILE *out, const fg_foil *foil) {
  char moved[FG_CORRECTION_WORDS], added[FG_CORRECTION_WORDS], left[FG_CHOICE_WORDS];
  fg_correction_moved(&foil->correction, moved, sizeof moved);
  fg_correction_added(&foil->correction, added, sizeof added);
  if (moved[0]) fprintf(out, "  the model moved %s\n  and added %s\n", moved, added);
  for (int k = 0; k < FG_CORRECTED; k++) {
    fg_choice_words(fg_corrected_symbol((fg_corrected)k), &foil->choice[k], false, left);
    if (left[0]) fprintf(out, "  %s\n", left);
  }
}

static void put_place(FILE *out, const fg_foil *foil) {
  fprintf(out, "  place on the bed x %.1f, y %.1f mm (%.1f × %.1f mm)\n", foil->place_mm[0],
          foil->place_mm[1], foil->place_mm[2], foil->place_mm[3]);
}

/* Writes the words in two lines of less than 100 columns. */
static void put_thickness_words(FILE *out, const fg_design *design, const fg_foil *foil) {
  char words[200];
  fg_thickness_words(design, foil, words, sizeof words);
  char *rest = strstr(words, ", and ");
  if (rest) fprintf(out, "    %.*s,\n    %s\n", (int)(rest - words), words, rest + 2);
}

static void put_quantities(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count =
      fg_quantity_shown(FG_QUANTITY_OF_FOIL, FG_QUANTITY_ON_TERMINAL, design->kind, shown);
  for (size_t i = 0; i < count; i++) {
    put_quantity(out, foil, shown[i]);
    if (shown[i]->offset == offsetof(fg_foil, thickness.mm)) put_thickness_words(out, design, foil);
  }
}

static void put_foil(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_foil_view *view = fg_foil_view_of(design->kind);
  char defect[200];
  if (foil->flags & FG_FOIL_NOT_MEASURED) {
    fprintf(out, "\nfoil %d: not measured: %s\n", foil->number, foil->error);
    put_place(out, foil);
    put_foil_flags(out, fg_foil_flags_told(design, foil) & ~(unsigned)FG_FOIL_NOT_MEASURED);
    return;
  }
  fprintf(out, "\nfoil %d: ", foil->number);
  view->foil_heading(foil, out);
  fputc('\n', out);
  if (foil->flags & FG_FOIL_NOT_THIS_DESIGN) fprintf(out, "  NOT MEASURED: %s\n", foil->error);
  if (fg_foil_defect(design, foil, defect, sizeof defect)) fprintf(out, "  REJECTED: %s\n", defect);
  put_place(out, foil);
  put_quantities(out, design, foil);
  fg_text_thickness_budget(out, design, foil);
  put_correction(out, foil);
  put_foil_flags(out, fg_foil_flags_told(design, foil));
  if (view->part_table) view->part_table(out, design, foil);
}

/* An error begins with the scan's name where it knows it. */
static void put_failed(FILE *out, const fg_report_scan *scan) {
  size_t length = strlen(scan->path);
  bool named = !strncmp(scan->error, scan->path, length) && scan->error[length] == ':';
  fprintf(out, "%s: not measured: %s\n", scan->path,
          named ? scan->error + length + 1 + strspn(scan->error + length + 1, " ") : scan->error);
}

static fg_status put_scan(fg_context *ctx, FILE *out, const fg_design *design,
                          const fg_report_scan *scan) {
  const fg_measurement *measurement = scan->measurement;
  if (!measurement) {
    put_failed(out, scan);
    return FG_OK;
  }
  fprintf(out, "%s: %lld × %lld px, %d bit, %.6g", scan->path,
          (long long)measurement->file.width_px, (long long)measurement->file.height_px,
          measurement->file.bit_depth, measurement->dpi[0]);
  if (measurement->dpi[0] != measurement->dpi[1]) fprintf(out, " × %.6g", measurement->dpi[1]);
  fputs(" dpi", out);
  if (measurement->file.colour)
    fprintf(out, ", channel %s", fg_channel_word(measurement->file.channel));
  fputc('\n', out);
  fg_text_colour_lines(out, measurement);
  fg_text_picture_state(out, measurement);
  fg_text_gauges(out, measurement);
  FG_TRY(fg_text_scan_model(ctx, out, measurement->model));
  for (size_t i = 0; i < measurement->foil_count; i++)
    put_foil(out, design, &measurement->foils[i]);
  if (measurement->disc_count) put_discs(out, design, measurement);
  if (measurement->grid) fg_text_grid(out, measurement);
  return FG_OK;
}

/* A line per thing that keeps the whole from passing: the worst first. */
static fg_status put_outcome(fg_context *ctx, FILE *out, const fg_report *report,
                             const fg_report_outcome *outcome) {
  const fg_design *design = report->design;
  char names[400];
  if (outcome->exceeded) {
    fprintf(out, "OUT OF TOLERANCE: %zu value(s) beyond a limit", outcome->exceeded);
    FG_TRY(fg_report_write_quantities(ctx, report, FG_VERDICT_FAIL, out));
    fputs(".\n", out);
  }
  if (outcome->rejected)
    fprintf(out, "REJECTED: %zu foil(s) with %s missing or too many.\n", outcome->rejected,
            fg_foil_view_of(design->kind)->parts);
  if (outcome->not_measured)
    fprintf(out, "INCOMPLETE: %zu without a value.\n", outcome->not_measured);
  if (outcome->undecided) {
    fprintf(out,
            fg_design_may_judge(design)
                ? "CANNOT TELL: a limit lies within ± of %zu value(s)"
                : "CANNOT TELL: the scanner's scale is not known, and %zu value(s) rest on it",
            outcome->undecided);
    FG_TRY(fg_report_write_quantities(ctx, report, FG_VERDICT_UNDECIDED, out));
    bool none_beyond = outcome->verdict == FG_VERDICT_UNDECIDED && fg_design_may_judge(design);
    fputs(none_beyond ? "; none is beyond a limit.\n" : ".\n", out);
    FG_TRY(fg_report_write_cures(ctx, report, out));
  }
  if (outcome->verdict == FG_VERDICT_PASS)
    fprintf(out, "Within every tolerance, uncertainty included. Traced to: %s.\n",
            fg_traceability_words[fg_design_traceability(design)]);
  size_t of_bearing = fg_report_of_bearing(design, names, sizeof names);
  if (outcome->verdict == FG_VERDICT_NONE)
    fprintf(out, "The design states no tolerances%s: nothing is judged.\n",
            of_bearing ? " of a foil" : "");
  if (of_bearing)
    fprintf(out, "Not judged here: %s: of a bearing; `foilgauge lot` judges it.\n", names);
  return FG_OK;
}

/* Says what lengths rest on; where that is nothing, what to do, unless the cures have said it. */
static void put_traceability(FILE *out, const fg_design *design, const fg_report_outcome *outcome) {
  char sentence[FG_TRACEABILITY_SENTENCE];
  fg_traceability_sentence(design, sentence, sizeof sentence);
  bool is_said = fg_design_may_judge(design) || outcome->undecided;
  fprintf(out, "Traced to: %s.\n", sentence);
  if (!is_said) fprintf(out, "%s\n", fg_traceability_cure);
}

fg_status fg_report_write_table(fg_context *ctx, const fg_report *report, FILE *out) {
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge(ctx, report, &outcome));
  for (size_t i = 0; i < report->scan_count; i++) {
    if (i) fputc('\n', out);
    FG_TRY(put_scan(ctx, out, report->design, &report->scans[i]));
  }
  fputc('\n', out);
  FG_TRY(put_outcome(ctx, out, report, &outcome));
  char scale[FG_SCALE_WORDS];
  fg_scale_words(fg_report_model(report), &report->design->calibration, scale, sizeof scale);
  const char *note = fg_foil_view_of(report->design->kind)->table_note;
  if (note) fputs(note, out);
  fprintf(out, "± is U = 2 u (k = 2, about 95 %%).\n%s\n", scale);
  put_traceability(out, report->design, &outcome);
  return fg_stream_finish(ctx, out, "the table");
}
