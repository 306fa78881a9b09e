/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of how each kind of foil is measured: one row per kind, in files kind_*.c. Kinds
 * that share functions share a file. */
#ifndef FG_GEOMETRY_FOIL_KIND_H
#define FG_GEOMETRY_FOIL_KIND_H

#include "foilgauge/foil_kind.h"
#include "geometry/layout.h"

typedef struct fg_foil_row {
  fg_foil_traits traits;
  size_t (*stated_parts)(const fg_design *design); /* that the design states; NULL: no parts */
  fg_status (*check)(fg_context *ctx, const fg_design *design); /* of its own dimensions */
  void (*derive)(const fg_design *design, fg_nominal *nominal); /* NULL: everything stays NaN */
  double (*min_object_mm)(const fg_design *design); /* diagonal of the smallest foil; else dust */
  double (*sagitta_over_chord)(const fg_design *design); /* of a foil bent as a whole; NULL */
  /* A strip seen from its edge: where bumps, lands and ends lie, then all values. NULL: no strip.
   */
  fg_status (*lay_out)(fg_context *ctx, const fg_design *design, unsigned threads, fg_foil *foil,
                       fg_layout *layout, const char **error);
  fg_status (*fill)(fg_context *ctx, const fg_design *design, fg_layout *layout, fg_foil *foil);
} fg_foil_row;

const fg_foil_row *fg_foil_row_of(fg_foil_kind kind);

extern const fg_foil_row fg_foil_kind_classical, fg_foil_kind_sinusoidal, fg_foil_kind_discs,
    fg_foil_kind_arc, fg_foil_kind_cantilever, fg_foil_kind_grid;

/* Strips with bumps (foil.c). */
fg_status fg_foil_lay_out_bumps(fg_context *ctx, const fg_design *design, unsigned threads,
                                fg_foil *foil, fg_layout *layout, const char **error);
fg_status fg_foil_fill_bumps(fg_context *ctx, const fg_design *design, fg_layout *layout,
                             fg_foil *foil);

/* FG_ERR_DATA with the member's name when it is not a number above 0. */
fg_status fg_design_check_positive(fg_context *ctx, const char *member, double value);

#endif
