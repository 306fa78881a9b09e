/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured grid in reports. */
#ifndef FG_REPORT_MEASURE_GRID_MEMBERS_H
#define FG_REPORT_MEASURE_GRID_MEMBERS_H

#include "core/member.h"
#include "foilgauge/foil.h"

extern const fg_members fg_grid_members;
extern const fg_members fg_grid_mark_members;

void fg_text_grid(FILE *out, const fg_measurement *measurement);
void fg_html_grid(FILE *out, const fg_measurement *measurement);
void fg_csv_grid_points(FILE *out, size_t scan, const fg_grid *grid);

/* An arrow of a map: place and displacement, mm of the scan. */
typedef struct fg_map_arrow {
  fg_point at_mm, move_mm;
  bool used;
} fg_map_arrow;

/* The bed with arrows, magnified so that the longest are seen; the scale says how much. */
void fg_html_arrows(FILE *out, const fg_map_arrow *arrows, size_t count, const double size_mm[2],
                    const char *label);

#endif
