/* The terminal's table: one block per foil, a row per bump, ± beside each value. */
#include <math.h>
#include <string.h>

#include "report/words.h"

/* The columns of the bump table and of the disc table: names of rows in the table of fields. */
static const char *const bump_columns[] = {"radius_mm", "bump_angle_deg", "intersection_angle_deg",
                                           "height_mm", "clearance_mm",   "radius_error_pct"};
static const char *const disc_columns[] = {"diameter_mm", "roundness_um", "rms_um", "coverage_deg"};

enum { COLUMNS_MAX = 8, DECIMALS_FINE = 5, DECIMALS_MAX = 7 };

typedef struct column {
  const fg_report_field *field;
  int decimals;
  int width;   /* of the value */
  int u_width; /* of ±; 0 without */
} column;

typedef struct row_set {
  fg_report_owner owner;
  const char *objects; /* an array */
  size_t count, size;
} row_set;

/* So many decimals that U = k u shows two digits; one, where two would be nanometres and less. */
int fg_report_decimals(const fg_report_field *field, double u) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!(expanded > 0)) return field->decimals;
  int decimals = 1 - (int)floor(log10(expanded));
  if (decimals > DECIMALS_FINE) decimals = (int)fmax(DECIMALS_FINE, decimals - 1);
  if (decimals < field->decimals) return field->decimals;
  return decimals > DECIMALS_MAX ? DECIMALS_MAX : decimals;
}

static int text_width(const char *text) {
  int width = 0;
  for (; *text; text++)
    if (((unsigned char)*text & 0xC0) != 0x80) width++; /* not a UTF-8 continuation byte */
  return width;
}

static int number_width(double value, int decimals) {
  return isfinite(value) ? snprintf(NULL, 0, "%.*f", decimals, value) : 1;
}

/* U of a value that is known. */
static double expanded_of(const fg_report_field *field, const void *object) {
  if (!isfinite(fg_report_value(field, object))) return NAN;
  return FG_COVERAGE_FACTOR * fg_report_uncertainty(field, object);
}

static void measure_column(column *target, const row_set *rows) {
  const fg_report_field *field = target->field;
  double largest_u = 0;
  for (size_t i = 0; i < rows->count; i++) {
    double u = fg_report_uncertainty(field, rows->objects + i * rows->size);
    if (u > largest_u) largest_u = u;
  }
  target->decimals = field->kind == FG_FIELD_COUNT ? 0 : fg_report_decimals(field, largest_u);
  target->width = text_width(field->symbol);
  if (text_width(field->unit) > target->width) target->width = text_width(field->unit);
  target->u_width = field->u_offset == FG_NO_UNCERTAINTY ? 0 : 1;
  for (size_t i = 0; i < rows->count; i++) {
    const void *object = rows->objects + i * rows->size;
    int width = number_width(fg_report_value(field, object), target->decimals);
    if (width > target->width) target->width = width;
    width = number_width(expanded_of(field, object), target->decimals);
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
    put_padded(out, units ? columns[i].field->unit : columns[i].field->symbol, columns[i].width);
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

static void put_row(FILE *out, const column *columns, size_t count, int number, unsigned flags,
                    const void *object) {
  fprintf(out, "%4d", number);
  for (size_t i = 0; i < count; i++) {
    const column *at = &columns[i];
    fputs("  ", out);
    put_number(out, fg_report_value(at->field, object), at->decimals, at->width);
    if (!at->u_width) continue;
    fputc(' ', out);
    put_number(out, expanded_of(at->field, object), at->decimals, at->u_width);
  }
  put_flags(out, fg_bump_flag_words(), flags);
  fputc('\n', out);
}

static size_t make_columns(const char *const *names, size_t count, const row_set *rows,
                           column *columns) {
  size_t used = 0;
  for (size_t i = 0; i < count && used < COLUMNS_MAX; i++) {
    columns[used].field = fg_report_find(rows->owner, names[i]);
    if (columns[used].field) measure_column(&columns[used++], rows);
  }
  return used;
}

static void put_bumps(FILE *out, const fg_foil *foil) {
  const row_set rows = {FG_REPORT_BUMP, (const char *)foil->bumps, foil->bump_count,
                        sizeof *foil->bumps};
  column columns[COLUMNS_MAX];
  size_t count =
      make_columns(bump_columns, sizeof bump_columns / sizeof *bump_columns, &rows, columns);
  fputs("bump", out);
  put_cells(out, columns, count, false);
  fputs("    ", out);
  put_cells(out, columns, count, true);
  for (size_t i = 0; i < foil->bump_count; i++)
    put_row(out, columns, count, foil->bumps[i].number, foil->bumps[i].flags, &foil->bumps[i]);
}

static void put_discs(FILE *out, const fg_measurement *measurement) {
  const row_set rows = {FG_REPORT_DISC, (const char *)measurement->discs, measurement->disc_count,
                        sizeof *measurement->discs};
  column columns[COLUMNS_MAX];
  size_t count =
      make_columns(disc_columns, sizeof disc_columns / sizeof *disc_columns, &rows, columns);
  fputs("disc", out);
  put_cells(out, columns, count, false);
  fputs("    ", out);
  put_cells(out, columns, count, true);
  for (size_t i = 0; i < measurement->disc_count; i++)
    put_row(out, columns, count, measurement->discs[i].number, measurement->discs[i].flags,
            &measurement->discs[i]);
}

/* "overall radius 20.9500 ± 0.0012 mm" */
static void put_quantity(FILE *out, const fg_foil *foil, const char *name) {
  const fg_report_field *field = fg_report_find(FG_REPORT_FOIL, name);
  double value = fg_report_value(field, foil), u = fg_report_uncertainty(field, foil);
  int decimals = fg_report_decimals(field, u);
  fprintf(out, "  %s ", field->words);
  put_number(out, value, decimals, 0);
  if (isfinite(u)) fprintf(out, " ± %.*f", decimals, FG_COVERAGE_FACTOR * u);
  fprintf(out, " %s\n", field->unit);
}

static void put_foil_flags(FILE *out, unsigned flags) {
  for (const fg_flag_words *words = fg_foil_flag_words(); words->name; words++)
    if (flags & words->flag) fprintf(out, "  %s: %s\n", words->name, words->plain);
}

static void put_place(FILE *out, const fg_foil *foil) {
  fprintf(out, "  place on the bed x %.1f, y %.1f mm (%.1f × %.1f mm)\n", foil->place_mm[0],
          foil->place_mm[1], foil->place_mm[2], foil->place_mm[3]);
}

static void put_foil(FILE *out, const fg_foil *foil) {
  if (foil->flags & FG_FOIL_NOT_MEASURED) {
    fprintf(out, "\nfoil %d: not measured: %s\n", foil->number, foil->error);
    put_place(out, foil);
    put_foil_flags(out, foil->flags & ~(unsigned)FG_FOIL_NOT_MEASURED);
    return;
  }
  fprintf(out, "\nfoil %d: %zu bumps, %s\n", foil->number, foil->bump_count,
          fg_orientation_word(foil->orientation));
  put_place(out, foil);
  put_quantity(out, foil, "overall.radius_mm");
  put_quantity(out, foil, "overall.springback_error_pct");
  put_quantity(out, foil, "thickness_mm");
  put_quantity(out, foil, "noise_um");
  put_foil_flags(out, foil->flags);
  put_bumps(out, foil);
}

static void put_scan(FILE *out, const fg_report_scan *scan) {
  const fg_measurement *measurement = scan->measurement;
  if (!measurement) {
    fprintf(out, "%s: not measured: %s\n", scan->path, scan->error);
    return;
  }
  fprintf(out, "%s: %lld × %lld px, %d bit, %.6g", scan->path, (long long)measurement->width_px,
          (long long)measurement->height_px, measurement->bit_depth, measurement->dpi[0]);
  if (measurement->dpi[0] != measurement->dpi[1]) fprintf(out, " × %.6g", measurement->dpi[1]);
  fputs(" dpi", out);
  if (measurement->colour) fprintf(out, ", channel %s", fg_channel_word(measurement->channel));
  fputc('\n', out);
  for (size_t i = 0; i < measurement->foil_count; i++)
    put_foil(out, &measurement->foils[i]);
  if (measurement->disc_count) put_discs(out, measurement);
}

static void put_outcome(FILE *out, const fg_report_outcome *outcome) {
  switch (outcome->verdict) {
  case FG_VERDICT_PASS:
    fputs("Within every tolerance, uncertainty included.\n", out);
    break;
  case FG_VERDICT_FAIL:
    fprintf(out, "OUT OF TOLERANCE: %zu value(s) beyond a limit.\n", outcome->exceeded);
    break;
  case FG_VERDICT_UNDECIDED:
    fputs("CANNOT TELL: a limit lies within ± of a value", out);
    if (outcome->exceeded) fprintf(out, "; %zu value(s) beyond a limit", outcome->exceeded);
    fputs(".\n", out);
    break;
  case FG_VERDICT_NOT_MEASURED:
    fprintf(out, "INCOMPLETE: %zu without a value.\n", outcome->not_measured);
    break;
  case FG_VERDICT_NONE:
    fputs("The design states no tolerances.\n", out);
    break;
  }
}

fg_status fg_report_write_table(fg_context *ctx, const fg_report *report, FILE *out) {
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge(ctx, report, &outcome));
  for (size_t i = 0; i < report->scan_count; i++) {
    if (i) fputc('\n', out);
    put_scan(out, &report->scans[i]);
  }
  fputc('\n', out);
  put_outcome(out, &outcome);
  fputs("± is U = 2 u (k = 2, about 95 %). The scanner's own scale error is not in it.\n", out);
  return fg_report_finish(ctx, out, "the table");
}
