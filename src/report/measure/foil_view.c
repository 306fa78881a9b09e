/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/foil_view.h"

#include <assert.h>

#include "core/text.h"
#include "foilgauge/words.h"
#include "report/measure/foil_members.h"

static void head_bumps(const fg_foil *foil, FILE *out) {
  fprintf(out, "%zu bump%s, %s", foil->bump_count, fg_plural(foil->bump_count),
          fg_orientation_word(foil->orientation));
}

static void head_bumps_on_page(const fg_foil *foil, FILE *out) {
  if (foil->flags & FG_FOIL_NOT_MEASURED) return;
  fputs(" · ", out);
  head_bumps(foil, out);
}

static const fg_foil_view bumps = {
    .parts = "bumps",
    .u_from = FG_EDGES_SAY,
    .spread_over = "bumps",
    .legend = "Orange: bump circles, solid where the fit used them. Blue, dashed: overall circle. "
              "Magenta: residuals. A red ring and value: beyond a limit; amber, with a question "
              "mark: cannot be told.",
    .overlay_note = FG_ARCS_NOTE,
    .table_note = "h and C_loc: the foil free, as scanned. C_fit: pressed into the sleeve.\n",
    .summary_heads = "<th>overall radius<br>mm</th><th>bump radius, mean<br>mm</th><th>height, "
                     "mean<br>mm</th>",
    .points_heading = FG_STATIONS_HEADING,
    .lines = FG_QUANTITY_OF_BUMP,
    .members = &fg_foil_members,
    .design_table = fg_design_table_of_bumps,
    .foil_heading = head_bumps,
    .part_table = fg_part_table_of_bumps,
    .page_heading = head_bumps_on_page,
    .tiles = fg_tiles_of_bumps,
    .details = fg_details_of_bumps,
    .summary = fg_summary_of_bumps,
    .overlay = fg_overlay_of_bumps,
};

static void head_beams(const fg_foil *foil, FILE *out) {
  fprintf(out, "flat, %zu beams", foil->beam_count);
}

static void head_beams_on_page(const fg_foil *foil, FILE *out) {
  fprintf(out, " · a flat foil, %zu beams", foil->beam_count);
}

static const fg_foil_view beams = {
    .parts = "beams",
    .u_from = "the flanks and the core of every edge say against each other",
    .spread_over = "beams",
    .legend = "Orange: the fitted edges of every beam, with its number. Blue, dashed: root line "
              "and axis. Magenta: residuals, longer than drawn are cut at 1 mm. A red ring and "
              "value: beyond a limit, or no length; amber, with a question mark: cannot be told.",
    .overlay_note = "± is U = 2 u (k = 2, about 95 %). Orange: fitted edges; blue: root line "
                    "and axis. Whiskers: residuals.",
    .table_note =
        "e_S, e_s: compliance and sagitta against the design's, of L and w as measured.\n",
    .summary_heads = "<th>length, mean<br>mm</th><th>width, mean<br>mm</th><th>compliance against "
                     "the design, mean<br>%</th>",
    .points_heading = "scan,foil,beam,side,station,x_mm,y_mm,u_um,usable\n",
    .lines = FG_QUANTITY_OF_BEAM,
    .members = &fg_flat_foil_members,
    .design_table = fg_design_table_of_beams,
    .foil_heading = head_beams,
    .part_table = fg_part_table_of_beams,
    .page_heading = head_beams_on_page,
    .tiles = fg_tiles_of_beams,
    .details = fg_details_of_beams,
    .summary = fg_summary_of_beams,
    .overlay = fg_overlay_of_beams,
};

/* A scan of discs or of a grid has no foils: functions of foils are those of foils with bumps. */
#define OF_SCANS_WITHOUT_FOILS                                                                     \
  .u_from = FG_EDGES_SAY, .overlay_note = FG_ARCS_NOTE, .summary_heads = "",                       \
  .lines = FG_QUANTITY_OF_DISC, .members = &fg_foil_members, .foil_heading = head_bumps,           \
  .part_table = fg_part_table_of_bumps, .page_heading = head_bumps_on_page,                        \
  .tiles = fg_tiles_of_bumps, .details = fg_details_of_bumps, .overlay = fg_overlay_of_bumps

static const fg_foil_view discs = {
    .parts = "bumps",
    .spread_over = "bumps",
    .legend = "Orange: the circle that was fitted to each feature, with its number. Magenta: how "
              "far the edge lies from it. A red ring and value: beyond a limit.",
    .points_heading = "scan,disc,point,x_mm,y_mm,residual_um\n",
    .design_table = fg_design_table_of_discs,
    OF_SCANS_WITHOUT_FOILS,
};

/* Values of a grid stand in an object of their own. */
static const fg_foil_view grid = {
    .parts = "marks",
    .spread_over = "marks",
    .legend = "Blue: the lattice that was fitted. Magenta: how far each mark lies from it, "
              "magnified as the scale says.",
    .points_heading = "scan,column,row,x_mm,y_mm,u_um,residual_x_um,residual_y_um,used\n",
    .design_table = fg_design_table_of_grid,
    OF_SCANS_WITHOUT_FOILS,
};

static const fg_foil_view *const views[] = {
    [FG_FOIL_CLASSICAL] = &bumps,      [FG_FOIL_SINUSOIDAL] = &bumps, [FG_FOIL_DISCS] = &discs,
    [FG_FOIL_ARC] = &fg_foil_view_arc, [FG_FOIL_CANTILEVER] = &beams, [FG_FOIL_GRID] = &grid,
};
static_assert(sizeof views / sizeof *views == FG_FOIL_KINDS, "every kind of foil has a view");

const fg_foil_view *fg_foil_view_of(fg_foil_kind kind) {
  return views[kind];
}
