/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A board to print: marks on a square lattice in mm, with its numbers beside them. It fills its
 * sheet, and it looks the same after no turn: three marks of a corner are left out, and the numbers
 * are on two sides alone. */
#include <math.h>

#include "foilgauge/design_report.h"
#include "foilgauge/words.h"
#include "page/page.h"

/* Margins that printers leave, with the numbers; mm. */
#define MARGIN_MM   14.0
#define TEXT_MM     2.6
#define PITCH_START 5.0
/* Of the pitch: a dot's diameter, a stroke's width, a cross, a line of a ruler. */
#define DOT_SHARE    0.5
#define STROKE_SHARE 0.08
#define CROSS_SHARE  0.6
#define LINE_SHARE   4.0
enum { NUMBERED_EACH = 5, COUNT_MIN = 3 };

/* Lattice on the sheet. */
typedef struct board_sheet {
  FILE *out;
  fg_mark_kind marks;
  double pitch, width, height, left, top; /* mm; place of the first mark */
  int columns, rows;
} board_sheet;

static int count_steps(double length, double pitch) {
  return (int)floor((length - 2 * MARGIN_MM) / pitch + 1e-9);
}

static board_sheet lay_sheet(const fg_design_grid *grid, const fg_board_sheet *size, FILE *out) {
  double pitch = grid->pitch_mm > 0 ? grid->pitch_mm : PITCH_START;
  board_sheet sheet = {.out = out,
                       .marks = grid->marks,
                       .pitch = pitch,
                       .width = size->width_mm,
                       .height = size->height_mm,
                       .columns = count_steps(size->width_mm, pitch) + 1,
                       .rows = count_steps(size->height_mm, pitch) + 1};
  if (grid->marks == FG_MARKS_CHESSBOARD) sheet.columns -= 1, sheet.rows -= 1;
  if (grid->marks == FG_MARKS_LINES) sheet.rows = 1;
  sheet.left = 0.5 * (sheet.width - (sheet.columns - 1) * pitch);
  sheet.top = 0.5 * (sheet.height - (sheet.rows - 1) * pitch);
  return sheet;
}

/* The corner's three marks tell how the board was turned. */
static bool is_left_out(const board_sheet *sheet, int column, int row) {
  return sheet->rows > 1 && column + row <= 1;
}

static void put_stroke(const board_sheet *sheet, double x, double y, double dx, double dy) {
  fprintf(sheet->out, "<path d=\"M%.4f %.4fL%.4f %.4f\"/>\n", x - dx, y - dy, x + dx, y + dy);
}

static void put_mark(const board_sheet *sheet, double x, double y) {
  double half = 0.5 * CROSS_SHARE * sheet->pitch;
  if (sheet->marks == FG_MARKS_DOTS) {
    fprintf(sheet->out, "<circle cx=\"%.4f\" cy=\"%.4f\" r=\"%.4f\"/>\n", x, y,
            0.5 * DOT_SHARE * sheet->pitch);
  } else if (sheet->marks == FG_MARKS_LINES) {
    put_stroke(sheet, x, y, 0, 0.5 * LINE_SHARE * sheet->pitch);
  } else {
    put_stroke(sheet, x, y, half, 0);
    put_stroke(sheet, x, y, 0, half);
  }
}

/* Every second square, in one path: seams between squares of their own would show. */
static void put_squares(const board_sheet *sheet) {
  fputs("<path d=\"", sheet->out);
  for (int j = 0; j <= sheet->rows; j++)
    for (int i = j % 2; i <= sheet->columns; i += 2)
      fprintf(sheet->out, "M%.4f %.4fh%.4fv%.4fh-%.4fz", sheet->left + (i - 1) * sheet->pitch,
              sheet->top + (j - 1) * sheet->pitch, sheet->pitch, sheet->pitch, sheet->pitch);
  fputs("\"/>\n", sheet->out);
}

static void put_all_marks(const board_sheet *sheet) {
  fprintf(sheet->out, "<g id=\"marks\" fill=\"%s\" stroke=\"%s\" stroke-width=\"%.4f\">\n",
          sheet->marks == FG_MARKS_DOTS || sheet->marks == FG_MARKS_CHESSBOARD ? "#000" : "none",
          sheet->marks == FG_MARKS_CROSSES || sheet->marks == FG_MARKS_LINES ? "#000" : "none",
          STROKE_SHARE * sheet->pitch);
  if (sheet->marks == FG_MARKS_CHESSBOARD) {
    put_squares(sheet);
  } else {
    for (int j = 0; j < sheet->rows; j++)
      for (int i = 0; i < sheet->columns; i++)
        if (!is_left_out(sheet, i, j))
          put_mark(sheet, sheet->left + i * sheet->pitch, sheet->top + j * sheet->pitch);
  }
  fputs("</g>\n", sheet->out);
}

static void put_number(const board_sheet *sheet, double x, double y, int number) {
  fprintf(sheet->out, "<text x=\"%.2f\" y=\"%.2f\">%d</text>\n", x, y, number);
}

/* Columns above the board, rows left of it, from 0 as in a report. */
static void put_numbers(const board_sheet *sheet) {
  double beside = (sheet->marks == FG_MARKS_CHESSBOARD ? 1 : 0.5) * sheet->pitch + TEXT_MM;
  if (sheet->marks == FG_MARKS_LINES) beside = 0.5 * LINE_SHARE * sheet->pitch + TEXT_MM;
  for (int i = 0; i < sheet->columns; i += NUMBERED_EACH)
    put_number(sheet, sheet->left + i * sheet->pitch, sheet->top - beside + 0.5 * TEXT_MM, i);
  for (int j = NUMBERED_EACH; j < sheet->rows; j += NUMBERED_EACH)
    put_number(sheet, sheet->left - beside, sheet->top + j * sheet->pitch + 0.35 * TEXT_MM, j);
}

static void put_legend(const board_sheet *sheet) {
  fprintf(sheet->out, "<text x=\"%.2f\" y=\"%.2f\">foilgauge: %s, pitch %.6g mm, %d",
          0.5 * sheet->width, sheet->height - 0.35 * MARGIN_MM, fg_mark_kind_word(sheet->marks),
          sheet->pitch, sheet->columns);
  if (sheet->rows > 1) fprintf(sheet->out, " × %d", sheet->rows);
  fputs(". Print at 100 %: the printer's own error is found by turned scans.</text>\n", sheet->out);
}

fg_status fg_design_write_board(fg_context *ctx, const fg_design *design,
                                const fg_board_sheet *size, FILE *out) {
  if (design->kind != FG_FOIL_GRID)
    return fg_fail(ctx, FG_ERR_DATA,
                   "form \"%s\" is no board: --svg needs a design of form \"grid\"",
                   fg_foil_kind_word(design->kind));
  board_sheet sheet = lay_sheet(&design->grid, size, out);
  if (sheet.columns < COUNT_MIN || (sheet.rows < COUNT_MIN && sheet.marks != FG_MARKS_LINES))
    return fg_fail(ctx, FG_ERR_DATA,
                   "a sheet of %g by %g mm has no room for %d marks of %g mm pitch along each side",
                   size->width_mm, size->height_mm, COUNT_MIN, sheet.pitch);
  fprintf(out,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%gmm\" height=\"%gmm\" viewBox=\"0 0 "
          "%g %g\">\n<title>",
          sheet.width, sheet.height, sheet.width, sheet.height);
  fg_html_text(out, design->name);
  fprintf(out, "</title>\n<rect width=\"%g\" height=\"%g\" fill=\"#fff\"/>\n", sheet.width,
          sheet.height);
  put_all_marks(&sheet);
  fprintf(
      out,
      "<g font-family=\"sans-serif\" font-size=\"%.2f\" text-anchor=\"middle\" fill=\"#000\">\n",
      TEXT_MM);
  put_numbers(&sheet);
  put_legend(&sheet);
  fputs("</g>\n</svg>\n", out);
  return FG_OK;
}
