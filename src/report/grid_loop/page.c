/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on grids for people: terminal and page. */
#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "core/text.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/grid_loop/members.h"
#include "report/measure/grid_members.h"

static void put_errors(FILE *out, const fg_grid_loop_result *r) {
  fprintf(out, "Marks lie %.2f µm rms from their lattice before, %.2f after", r->before_um,
          r->after_um);
  if (isfinite(r->held_out_after_um))
    fprintf(out, "; %s %.2f before, %.2f after",
            r->held_out_scans ? "marks of the scans held out" : "held-out marks",
            r->held_out_before_um, r->held_out_after_um);
  fputs(".\n", out);
}

static void put_map_words(FILE *out, const fg_grid_loop_result *r) {
  if (r->map_um > 0)
    fprintf(out,
            "A smooth map of %.2f µm rms over %.0f × %.0f mm is left beside the effects; the whole "
            "displacement has U = %.2f µm rms.\n",
            r->map_um, r->high_mm[0] - r->low_mm[0], r->high_mm[1] - r->low_mm[1], 2 * r->u_map_um);
  if (r->board_map_um > 0)
    fprintf(out, "The board itself is bent by %.2f µm rms.\n", r->board_map_um);
  if (isfinite(r->carriage_um))
    fprintf(out, "The carriage differs by %.2f µm from scan to scan, which no model removes.\n",
            r->carriage_um);
}

fg_status fg_grid_loop_write_text(fg_context *ctx, const fg_grid_loop *loop, FILE *out) {
  const fg_grid_loop_result *r = fg_grid_loop_result_of(loop);
  const fg_subject list = {.object = r, .whole = r};
  fprintf(out, "%zu scan%s, %zu marks\n%s\n", r->scans, fg_plural(r->scans), r->marks, r->sentence);
  fg_members_terminal(out, "  ", &fg_grid_claim_members, &list, fg_grid_loop_find_claim);
  put_errors(out, r);
  put_map_words(out, r);
  if (r->advice[0]) fprintf(out, "%s\n", r->advice);
  fputs("± is U = 2 u (k = 2, about 95 %).\n", out);
  return fg_stream_finish(ctx, out, "the report");
}

static void put_grid_tiles(FILE *out, const fg_grid_loop_result *r) {
  bool held_out = isfinite(r->held_out_after_um);
  const fg_tile tiles[] = {
      {"Marks before", .value = r->before_um, .digits = 3, .unit = "µm", .small = "rms"},
      {"Marks after", .value = r->after_um, .digits = 3, .unit = "µm", .small = "rms"},
      {held_out ? "Held-out marks, after" : NULL, .value = r->held_out_after_um, .digits = 3,
       .unit = "µm", .small = "rms"},
      {"U of the map", .value = 2 * r->u_map_um, .digits = 3, .unit = "µm", .small = "rms"},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_grid_map(FILE *out, const fg_grid_loop_result *r) {
  size_t count = r->map_columns * r->map_rows;
  const fg_measurement *m = r->scan[0].measurement;
  double size_mm[2];
  fg_measurement_size_mm(m, size_mm);
  fg_map_arrow *arrows = malloc((count + 1) * sizeof *arrows);
  for (size_t i = 0; arrows && i < count; i++)
    arrows[i] =
        (fg_map_arrow){r->map[i].at_mm, {r->map[i].d_um.x / 1000, r->map[i].d_um.y / 1000}, true};
  if (arrows)
    fg_html_arrows(out, arrows, count, size_mm, "Displacement of the scanner: true less measured");
  free(arrows);
}

static void put_scan_residuals(FILE *out, const fg_grid_scan *scan) {
  const fg_measurement *m = scan->measurement;
  const fg_grid *grid = m->grid;
  double size_mm[2];
  fg_measurement_size_mm(m, size_mm);
  fg_map_arrow *arrows = malloc((grid->count + 1) * sizeof *arrows);
  fputs("<h3>", out);
  fg_html_text(out, m->scan);
  fputs("</h3>\n", out);
  for (size_t i = 0; arrows && i < grid->count; i++)
    arrows[i] = (fg_map_arrow){grid->marks[i].at_mm, scan->residual_mm[i], grid->marks[i].used};
  if (arrows) fg_html_arrows(out, arrows, grid->count, size_mm, "Marks after all corrections");
  free(arrows);
}

fg_status fg_grid_loop_write_html(fg_context *ctx, const fg_grid_loop *loop, FILE *out) {
  const fg_grid_loop_result *r = fg_grid_loop_result_of(loop);
  const fg_subject list = {.object = r, .whole = r};
  fg_html_begin(out, "Scanner's bed");
  fputs("<section><header><h1>The scanner's bed</h1></header>\n<p>", out);
  fg_html_text(out, r->sentence);
  fputs("</p>\n", out);
  put_grid_tiles(out, r);
  if (r->advice[0]) {
    fputs("<p class=\"next\"><b>To know more:</b> ", out);
    fg_html_text(out, r->advice);
    fputs("</p>\n", out);
  }
  fputs("<h2>Effects</h2>\n", out);
  fg_html_table(out, &fg_grid_claim_members, &list, fg_grid_loop_find_claim);
  fputs("<h2>Map of the bed</h2>\n<p>", out);
  put_map_words(out, r);
  fputs("</p>\n", out);
  put_grid_map(out, r);
  fputs("<h2>What is left</h2>\n<p>", out);
  put_errors(out, r);
  fputs("</p>\n", out);
  if (r->held_out_scans)
    fg_html_table(out, &fg_grid_held_out_members, &list, fg_grid_loop_find_held_out);
  for (size_t i = 0; i < r->scans; i++)
    put_scan_residuals(out, &r->scan[i]);
  fputs("<h2>Scans</h2>\n", out);
  fg_html_table(out, &fg_grid_scan_members, &list, fg_grid_loop_find_scan);
  fputs("</section>\n", out);
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
