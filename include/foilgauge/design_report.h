/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design and its derived values, as `foilgauge design` writes them. */
#ifndef FOILGAUGE_DESIGN_REPORT_H
#define FOILGAUGE_DESIGN_REPORT_H

#include <stdio.h>

#include "foilgauge/bearing.h"
#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_design_report {
  const fg_design *design;
  const fg_nominal *nominal;        /* fg_design_derive */
  const fg_arch_material *material; /* of the strip, for the stiffness of its bumps */
  const char *path;                 /* of the design's file, which dates it; NULL: none */
} fg_design_report;

/* "foilgauge/nominal/1", reports/schema/nominal.schema.json. */
fg_status fg_design_write_json(fg_context *ctx, const fg_design_report *report, FILE *out);

/* Writes a table for the terminal. */
fg_status fg_design_write_table(fg_context *ctx, const fg_design_report *report, FILE *out);

/* Writes the clearance under the declared springback model, as CSV: bump radius error from -5 to
 * +30 %. FG_ERR_DATA for a form without bumps. */
fg_status fg_design_write_curve(fg_context *ctx, const fg_design_report *report, FILE *out);

/* One self-contained page, with the stiffness of a bump. FG_ERR_DATA for a form without bumps. */
fg_status fg_design_write_html(fg_context *ctx, const fg_design_report *report, FILE *out);

/* Sheet of a board, with the margins that printers leave. */
typedef struct fg_board_sheet {
  double width_mm, height_mm;
} fg_board_sheet;

/* A board of a design of form "grid", as SVG in mm: as many marks as the sheet holds, of the pitch
 * as stated, or 5 mm. FG_ERR_DATA for another form, or a sheet without room. */
fg_status fg_design_write_board(fg_context *ctx, const fg_design *design,
                                const fg_board_sheet *size, FILE *out);

#ifdef __cplusplus
}
#endif
#endif
