/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jumps of a whole row or column: rows that a scanner lost or read twice, pieces of a scan that
 * were stitched, seams between the chips of a contact image sensor. They come after the optics, so
 * they are sharp. */
#ifndef FG_RENDER_JUMPS_H
#define FG_RENDER_JUMPS_H

#include "render/members.h"

enum { FG_RENDER_JUMPS_MAX = 64 /* of each kind */ };

/* After the place `count` rows of the glass were never read; negative: the carriage stood still,
 * and the row before it was read as often again. */
typedef struct fg_rows_lost {
  double y_mm;
  int count;
} fg_rows_lost;

typedef struct fg_chip_seam {
  double x_mm, shift_um, shift_y_um; /* of all that lies at larger x */
} fg_chip_seam;

/* After the place the picture goes on `rows` rows further on; negative: the rows before it come a
 * second time. */
typedef struct fg_stitch {
  double y_mm, shift_um; /* along x */
  int rows;
} fg_stitch;

typedef struct fg_jump_requests {
  fg_rows_lost rows[FG_RENDER_JUMPS_MAX];
  fg_chip_seam seams[FG_RENDER_JUMPS_MAX];
  fg_stitch stitches[FG_RENDER_JUMPS_MAX];
  size_t row_count, seam_count, stitch_count;
} fg_jump_requests;

/* True = nominal + d beyond at_mm; `repeats` times in all, every_mm apart. */
typedef struct fg_render_jump {
  int axis; /* 0 x, 1 y: axis across the jump */
  double at_mm, every_mm;
  int repeats;
  double d_mm[2]; /* of one */
} fg_render_jump;

typedef struct fg_render_jump_list {
  fg_render_jump each[3 * FG_RENDER_JUMPS_MAX];
  size_t count;
} fg_render_jump_list;

/* Reads members rows_lost, stitches and chip_seams of a spec's scanner. */
fg_status fg_jumps_read(const fg_place *place, const cJSON *scanner, fg_jump_requests *requests);

/* Builds the list, with each jump between two pixels. FG_ERR_DATA for one outside the picture. */
fg_status fg_jumps_build(const fg_place *place, const fg_jump_requests *requests,
                         const double pixel_mm[2], const double size_mm[2],
                         fg_render_jump_list *list);

/* Returns the shift down the picture by rows that are seen twice. */
double fg_jumps_rows_more(const fg_jump_requests *requests);

/* Adds to d(x, y); `side_mm` decides the side of a jump. */
void fg_jumps_field(const fg_render_jump_list *list, const double side_mm[2], double d_mm[2]);

/* The first jump along an axis at or above low_mm and below high_mm; NaN without. */
double fg_jumps_next(const fg_render_jump_list *list, int axis, double low_mm, double high_mm);

double fg_jumps_reach_mm(const fg_render_jump_list *list);

#endif
