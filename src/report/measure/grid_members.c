/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/grid_members.h"

#include <math.h>
#include <stdlib.h>

#include "page/page.h"

static const char *find_marks_word(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_mark_kind_word(((const fg_grid *)subject->object)->kind);
}

static double find_columns(const fg_subject *subject) {
  return ((const fg_grid *)subject->object)->columns;
}

static double find_rows(const fg_subject *subject) {
  return ((const fg_grid *)subject->object)->rows;
}

static bool is_chessboard(const fg_subject *subject) {
  return ((const fg_grid *)subject->object)->kind == FG_MARKS_CHESSBOARD;
}

static bool is_corrected(const fg_subject *subject) {
  return ((const fg_grid *)subject->object)->corrected;
}

static double find_mark_x(const fg_subject *subject) {
  return ((const fg_mark *)subject->object)->at_mm.x;
}

static double find_mark_y(const fg_subject *subject) {
  return ((const fg_mark *)subject->object)->at_mm.y;
}

static double find_residual_x(const fg_subject *subject) {
  return 1000 * ((const fg_mark *)subject->object)->residual_mm.x;
}

static double find_residual_y(const fg_subject *subject) {
  return 1000 * ((const fg_mark *)subject->object)->residual_mm.y;
}

static double find_mark_u(const fg_subject *subject) {
  return 1000 * ((const fg_mark *)subject->object)->u_mm;
}

static const fg_member mark_rows[] = {
    {FG_INTEGER("column", fg_mark, column), .words = "steps along the lattice's columns, from 0"},
    {FG_INTEGER("row", fg_mark, row)},
    {FG_NUMBER_BY("x_mm", find_mark_x), .words = "of the scan"},
    {FG_NUMBER_BY("y_mm", find_mark_y)},
    {FG_NUMBER_BY("u_um", find_mark_u),
     .words = "standard uncertainty of its place along x and along y, from the picture's noise"},
    {FG_NUMBER_BY("residual_x_um", find_residual_x), .words = "measured less fitted"},
    {FG_NUMBER_BY("residual_y_um", find_residual_y)},
    {FG_FLAG("used", fg_mark, used), .words = "false: an outlier of the lattice"},
};
const fg_members fg_grid_mark_members = FG_MEMBERS_OF_FILE(mark_rows, "mark", "measure");

#define VALUE(name_, field_) FG_NUMBER_U(name_, fg_grid, field_.value, field_.u)

static const fg_member value_rows[] = {
    {FG_TEXT_BY("marks_kind", find_marks_word), .options = FG_MEMBER_NEVER_NULL,
     .words = "dots, chessboard, crosses or lines"},
    {FG_COUNT_BY("columns", find_columns)},
    {FG_COUNT_BY("rows", find_rows)},
    {FG_COUNT("mark_count", fg_grid, count)},
    {FG_COUNT("used", fg_grid, used), .words = "marks that are no outliers of the lattice"},
    {FG_COUNT("missing", fg_grid, missing),
     .words = "places of the lattice without a mark: covered, damaged, or never there"},
    {FG_INTEGER("squares_per_step", fg_grid, squares_per_step), .present = is_chessboard,
     .words = "2: all corners that are seen lie two squares apart, and a step is two squares"},
    {VALUE("step_x_px", step_px[0]),
     .words = "step of the lattice along x of the scan, whatever its rotation"},
    {VALUE("step_y_px", step_px[1])},
    {VALUE("step_x_mm", step_mm[0]), .words = "the same at the scan's resolution"},
    {VALUE("step_y_mm", step_mm[1])},
    {VALUE("axis_ratio", axis_ratio), .words = "step along x over step along y, in mm"},
    {VALUE("shear", shear), .words = "shift along x per length along y"},
    {FG_NUMBER("rotation_deg", fg_grid, rotation_deg),
     .words = "of the columns' direction, from x towards y"},
    {FG_NUMBER("rms_um", fg_grid, rms_um),
     .words = "of the marks' distances from the fitted lattice, along one axis"},
    {FG_NUMBER("uncorrected_rms_um", fg_grid, uncorrected_rms_um), .present = is_corrected,
     .words = "the same without the scanner's model"},
    {FG_NUMBER("u_model_um", fg_grid, u_model_um), .present = is_corrected,
     .words = "standard uncertainty of these distances by the scanner's model, root mean square"},
    {FG_NUMBER("largest_um", fg_grid, largest_um)},
    {FG_NUMBER("mark_u_um", fg_grid, mark_u_um),
     .words = "standard uncertainty of a mark's place by the picture's noise, root mean square"},
    {FG_NUMBER("blur_um", fg_grid, blur_um), .words = "of the edges, sd"},
    {FG_LIST("marks", fg_grid, marks, count, &fg_grid_mark_members), .options = FG_MEMBER_ON_LINE},
};
const fg_members fg_grid_members = FG_MEMBERS_OF_FILE(value_rows, "grid", "measure");

/* ---- words ---- */

static void put_value(FILE *out, const char *before, fg_grid_value value, int decimals,
                      const char *after) {
  int shown = fg_decimals_by_u(decimals, value.u);
  fprintf(out, "%s%.*f ± %.*f%s", before, shown, value.value, shown, 2 * value.u, after);
}

static void put_steps(FILE *out, const fg_grid *grid) {
  const char *step = grid->squares_per_step == 2 ? "two squares" : "step";
  if (isfinite(grid->step_px[0].value)) {
    put_value(out, "", grid->step_px[0], 2, " px along x");
    put_value(out, " (", grid->step_mm[0], 4, " mm)");
  }
  if (isfinite(grid->axis_ratio.value)) fputs(", ", out);
  if (isfinite(grid->step_px[1].value)) {
    put_value(out, "", grid->step_px[1], 2, " px along y");
    put_value(out, " (", grid->step_mm[1], 4, " mm)");
  }
  fprintf(out, " for %s%s", *step == 't' ? "" : "one ", step);
}

static void put_grid_words(FILE *out, const fg_grid *grid, const char *between) {
  fprintf(out, "grid of %s: %zu marks, %d × %d places", fg_mark_kind_word(grid->kind), grid->count,
          grid->columns, grid->rows);
  if (grid->missing) fprintf(out, ", %zu without a mark", grid->missing);
  if (grid->used < grid->count) fprintf(out, ", %zu outliers", grid->count - grid->used);
  fputs(between, out);
  put_steps(out, grid);
  fputs(between, out);
  if (isfinite(grid->axis_ratio.value)) {
    put_value(out, "ratio of the axes ", grid->axis_ratio, 5, "");
    put_value(out, ", shear ", (fg_grid_value){1000 * grid->shear.value, 1000 * grid->shear.u}, 2,
              " mm/m");
    fputs(between, out);
  }
  fprintf(out,
          "marks lie %.2f µm rms from the lattice, at most %.2f; by the picture's noise it were "
          "%.2f",
          grid->rms_um, grid->largest_um, grid->mark_u_um);
  if (grid->corrected)
    fprintf(out, "%swithout the scanner's model it were %.2f µm rms; the model leaves U = %.2f µm",
            between, grid->uncorrected_rms_um, 2 * grid->u_model_um);
}

void fg_text_grid(FILE *out, const fg_measurement *measurement) {
  put_grid_words(out, measurement->grid, "\n  ");
  fputc('\n', out);
}

void fg_csv_grid_points(FILE *out, size_t scan, const fg_grid *grid) {
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    fprintf(out, "%zu,%d,%d,%.6f,%.6f,%.4f,%.4f,%.4f,%d\n", scan, m->column, m->row, m->at_mm.x,
            m->at_mm.y, 1000 * m->u_mm, 1000 * m->residual_mm.x, 1000 * m->residual_mm.y, m->used);
  }
}

/* ---- the map ---- */

enum { MAP_PX = 760, BAR_PX = 120 };

/* A length of 1, 2 or 5 times a power of ten, no longer than `most`. */
static double round_length(double limit) {
  double power = pow(10, floor(log10(limit))), digits = limit / power;
  return power * (digits >= 5 ? 5 : digits >= 2 ? 2 : 1);
}

static double typical_spacing(const double size_mm[2], size_t count) {
  return sqrt(size_mm[0] * size_mm[1] / (double)(count ? count : 1));
}

static void put_arrow(FILE *out, const fg_map_arrow *arrow, double scale, double magnification) {
  double x = arrow->at_mm.x * scale, y = arrow->at_mm.y * scale;
  fprintf(out, "<path d=\"M%.1f %.1fl%.1f %.1f\"%s/>", x, y,
          arrow->move_mm.x * scale * magnification, arrow->move_mm.y * scale * magnification,
          arrow->used ? "" : " stroke=\"#d08700\"");
  fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.2\" fill=\"#1f5f99\" stroke=\"none\"/>\n", x,
          y);
}

/* Box of a map in px: its frame with a margin, and the tips of all arrows that are used. */
typedef struct map_box {
  double left, right, top, bottom;
} map_box;

static map_box find_map_box(const fg_map_arrow *arrows, size_t count, double width, double height,
                            double px_per_mm, double magnification) {
  enum { MARGIN_PX = 8 };
  map_box box = {0, width, 0, height};
  for (size_t i = 0; i < count; i++) {
    if (!arrows[i].used) continue;
    double x = px_per_mm * (arrows[i].at_mm.x + magnification * arrows[i].move_mm.x);
    double y = px_per_mm * (arrows[i].at_mm.y + magnification * arrows[i].move_mm.y);
    box = (map_box){fmin(box.left, x), fmax(box.right, x), fmin(box.top, y), fmax(box.bottom, y)};
  }
  return (map_box){box.left - MARGIN_PX, box.right + MARGIN_PX, box.top - MARGIN_PX,
                   box.bottom + MARGIN_PX};
}

void fg_html_arrows(FILE *out, const fg_map_arrow *arrows, size_t count, const double size_mm[2],
                    const char *label) {
  double scale = MAP_PX / fmax(size_mm[0], size_mm[1]), longest = 0;
  for (size_t i = 0; i < count; i++)
    if (arrows[i].used) longest = fmax(longest, hypot(arrows[i].move_mm.x, arrows[i].move_mm.y));
  if (!(longest > 0)) longest = 1e-6;
  double magnification = round_length(1.2 * typical_spacing(size_mm, count) / longest);
  double bar_mm = round_length(BAR_PX / scale / magnification);
  double width = size_mm[0] * scale, height = size_mm[1] * scale;
  const map_box box = find_map_box(arrows, count, width, height, scale, magnification);
  enum { LEGEND_PX = 24 };
  double whole[2] = {box.right - box.left, box.bottom - box.top + LEGEND_PX};
  fprintf(out,
          "<figure><svg class=\"plot\" width=\"%.0f\" height=\"%.0f\" viewBox=\"%.0f %.0f %.0f "
          "%.0f\" role=\"img\" aria-label=\"%s\">\n",
          whole[0], whole[1], box.left, box.top, whole[0], whole[1], label);
  fprintf(out, "<rect width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"#9aa4ad\"/>\n", width,
          height);
  fputs("<g fill=\"none\" stroke=\"#c2188f\" stroke-width=\"1.3\">\n", out);
  for (size_t i = 0; i < count; i++)
    put_arrow(out, &arrows[i], scale, magnification);
  fprintf(out, "<path d=\"M4 %.1fl%.1f 0\" stroke-width=\"3\"/></g>\n", box.bottom + 10,
          bar_mm * scale * magnification);
  fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">%g µm; arrows are magnified %g times</text></svg>\n",
          bar_mm * scale * magnification + 12, box.bottom + 14, 1000 * bar_mm, magnification);
  fprintf(out, "<figcaption>%s. The frame is the scan, %.0f × %.0f mm.</figcaption></figure>\n",
          label, size_mm[0], size_mm[1]);
}

void fg_html_grid(FILE *out, const fg_measurement *m) {
  const fg_grid *grid = m->grid;
  double size_mm[2];
  fg_measurement_size_mm(m, size_mm);
  fg_map_arrow *arrows = malloc((grid->count + 1) * sizeof *arrows);
  fputs("<p>", out);
  put_grid_words(out, grid, "<br>\n");
  fputs("</p>\n", out);
  for (size_t i = 0; arrows && i < grid->count; i++)
    arrows[i] =
        (fg_map_arrow){grid->marks[i].at_mm, grid->marks[i].residual_mm, grid->marks[i].used};
  if (arrows) fg_html_arrows(out, arrows, grid->count, size_mm, "Marks against the fitted lattice");
  free(arrows);
}
