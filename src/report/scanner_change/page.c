/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scanner's change for people: terminal and page. */
#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "page/page.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/measure/grid_members.h"
#include "report/scanner_change/members.h"

static void put_models(FILE *out, const fg_scanner_change *change, const char *between) {
  const fg_scanner_model_facts *const each[] = {&change->older, &change->newer};
  for (int k = 0; k < 2; k++)
    fprintf(out, "%s: %s, %.10s, of %zu scan%s%s", k ? "newer" : "older", each[k]->path,
            each[k]->date ? each[k]->date : "not dated", each[k]->scans,
            each[k]->scans == 1 ? "" : "s", k ? "" : between);
}

static void put_scale_note(FILE *out, const fg_scanner_change *change) {
  if (change->scale_known) return;
  fputs("The scale of both axes together is not compared: one of the models was found without "
        "known sizes.\n",
        out);
}

fg_status fg_scanner_change_write_text(fg_context *ctx, const fg_scanner_change *change,
                                       FILE *out) {
  const fg_subject list = {.object = change, .whole = change};
  put_models(out, change, "\n");
  fprintf(out, "\n%s\n", change->sentence);
  fg_members_terminal(out, "  ", &fg_scanner_number_members, &list, fg_scanner_change_find_number);
  put_scale_note(out, change);
  fputs("± is U = 2 u (k = 2, about 95 %).\n", out);
  return fg_stream_finish(ctx, out, "the report");
}

static void put_change_tiles(FILE *out, const fg_scanner_change *change) {
  static const struct {
    const char *words;
    fg_tile_look look;
  } verdicts[] = {[FG_SCANNER_SAME] = {"No change shows", FG_TILE_GOOD},
                  [FG_SCANNER_SUSPECTED] = {"Suspected", FG_TILE_OPEN},
                  [FG_SCANNER_CHANGED] = {"Changed", FG_TILE_BAD}};
  const fg_tile tiles[] = {
      {"Scanner", .text = verdicts[change->verdict].words, .look = verdicts[change->verdict].look},
      {"Largest difference", .value = change->largest_um, .u = change->u_largest_um, .decimals = 2,
       .unit = "µm", .u_words = FG_TILE_U_IS_2U},
      {"p", .value = change->p_value, .digits = 2, .small = "that chance differs as much"},
      {"Would have shown", .value = change->would_show_um, .digits = 3, .unit = "µm",
       .small = "rms over the bed"},
  };
  fg_html_tiles(out, "tiles four", tiles, sizeof tiles / sizeof *tiles);
}

/* The frame of the picture begins at the glass's corner. */
static void put_change_map(FILE *out, const fg_scanner_change *change) {
  const double size[2] = {change->high_mm[0] + fmax(0, change->low_mm[0]),
                          change->high_mm[1] + fmax(0, change->low_mm[1])};
  fg_map_arrow *arrows = malloc((change->places + 1) * sizeof *arrows);
  for (size_t k = 0; arrows && k < change->places; k++) {
    const fg_scanner_place *place = &change->place[k];
    arrows[k] =
        (fg_map_arrow){place->at_mm, {place->d_um.x / 1000, place->d_um.y / 1000}, place->compared};
  }
  if (arrows)
    fg_html_arrows(out, arrows, change->places, size, "Displacement by the newer model less older");
  free(arrows);
}

fg_status fg_scanner_change_write_html(fg_context *ctx, const fg_scanner_change *change,
                                       FILE *out) {
  const fg_subject list = {.object = change, .whole = change};
  const fg_scanner_model_facts *const each[] = {&change->older, &change->newer};
  fg_html_begin(out, "Has the scanner changed?");
  fputs("<section><header><h1>Has the scanner changed?</h1></header>\n<p>", out);
  fg_html_text(out, change->sentence);
  fputs("</p>\n", out);
  put_change_tiles(out, change);
  fputs("<h2>Numbers</h2>\n", out);
  fg_html_table(out, &fg_scanner_number_members, &list, fg_scanner_change_find_number);
  fputs("<p>", out);
  put_scale_note(out, change);
  fputs("</p>\n<h2>Over the bed</h2>\n", out);
  put_change_map(out, change);
  fputs("<h2>Models</h2>\n<ul>\n", out);
  for (int k = 0; k < 2; k++) {
    fputs("<li>", out);
    fg_html_text(out, each[k]->path);
    fprintf(out, ", %.10s, of %zu scan%s: SHA-256 %s</li>\n",
            each[k]->date ? each[k]->date : "not dated", each[k]->scans,
            each[k]->scans == 1 ? "" : "s", each[k]->sha256);
  }
  fputs("</ul></section>\n", out);
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
