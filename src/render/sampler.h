/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coverage at a place of the picture before optical blur, smoothed just enough to be sampled.
 *
 * A sample is the strip seen through a Gaussian of sd `sd`, from its signed distance: the
 * difference of two normal distribution functions. At three samples a pixel and sd 0.3 px the
 * spectrum beyond the sampling rate is below 1e-6, so sums of samples are as good as integrals. On
 * a curved edge a smoothing along the normal alone is wrong by sd²/(2 radius): 1e-4 px on a bump.
 * The remaining blur, and the pixel's square, are two-dimensional (tile.c).
 */
#ifndef FG_RENDER_SAMPLER_H
#define FG_RENDER_SAMPLER_H

#include "render/spec.h"

enum {
  FG_BLOCK_PX = 8, /* lists of near things are kept per block of 8 × 8 pixels */
  FG_NEAR_MAX =
      128, /* max number of things near one block; the farthest of the list are left out */
  FG_PHI_STEPS = 2048,
};

/* A band of light or shade beside edges: the strip's own wall, or a shadow. Its value is coverage.
 */
typedef struct fg_side_band {
  double amplitude;
  double x, y;      /* direction */
  double width_rad; /* its share falls from 1 at the direction to 0 at this turn, and is a half at
                       half of it; 0: the cosine to the direction */
  double length_mm; /* decay */
  double gap_mm;
  bool of_discs; /* only for discs: strips and sheets always have it */
} fg_side_band;

enum { FG_SIDE_BANDS_MAX = 2 };

typedef struct fg_sampler {
  const fg_render_spec *spec;
  double pixel_mm[2];
  double sd_mm;         /* of the sampling */
  double edge_reach_mm; /* max distance from an undisturbed edge at which its blur can be seen */
  double reach_mm;      /* max distance from the midline of a thin strip at which a sample can be
                           non-zero */
  double side_mm[2];    /* x, y: side of jumps for the sample; NaN: its own */
  bool has_line;        /* it samples one of a colour sensor's lines: */
  double line_shift_mm[2], line_scale, line_middle_mm;
  double lag_mm; /* errors of the carriage at y are those of y + lag; 0 without lines */
  bool has_field, has_part, has_normal, has_width, has_bump, has_edge;
  double one_sided_mm; /* sd; 0 without */
  fg_side_band bands[FG_SIDE_BANDS_MAX];
  int band_count;
  double disc_band_mm; /* max distance beside a disc's edge at which its bands can be seen */
  float phi[FG_PHI_STEPS + 2];
} fg_sampler;

void fg_sampler_init(const fg_render_spec *spec, fg_sampler *sampler);

/* Switches to one line of a colour sensor for all later samples. */
void fg_sampler_use_line(fg_sampler *sampler, int line);

/* Things near one block, ascending: segments first, then shapes (segment_count + index). */
typedef struct fg_near {
  size_t ids[FG_NEAR_MAX];
  size_t count;
  bool filled; /* it lies within a sheet, away from its outlines */
} fg_near;

/* Value at a nominal place: 0 background, 1 foil. `sd_mm` is the smoothing. */
double fg_sample(const fg_sampler *sampler, const fg_near *near, double x_mm, double y_mm,
                 double sd_mm);

/* Returns true when a true position lies within a sheet: on the material's side of the nearest
 * outline. */
bool fg_sheet_inside(const fg_scene *scene, const fg_drawn_foil *drawn, double x_mm, double y_mm);

/* Lists of near things, per block of a band of rows. */
typedef struct fg_band_node {
  uint32_t id;
  int32_t next;
} fg_band_node;

typedef struct fg_band {
  int64_t column0, row0; /* block coordinates of the first block: floor(pixel / 8) */
  int64_t columns, rows;
  int32_t *heads; /* -1: empty */
  bool *filled;   /* within a sheet whose outlines are not in the list */
  fg_band_node *nodes;
  size_t node_count, node_capacity;
  double (*spans_px)[2]; /* first and last row within reach of a segment or shape */
} fg_band;

/* `margin_px` (a multiple of 8) is kept on all sides; `rows_px` is the band's height. */
fg_status fg_band_create(fg_context *ctx, const fg_sampler *sampler, int64_t rows_px,
                         int64_t margin_px, fg_band *band);
/* Fills the lists for the band whose first picture row is y0_px. */
fg_status fg_band_fill(fg_context *ctx, const fg_sampler *sampler, int64_t y0_px, int64_t margin_px,
                       fg_band *band);
void fg_band_gather(const fg_band *band, int64_t block_x, int64_t block_y, fg_near *near);
bool fg_band_any(const fg_band *band, int64_t x0, int64_t y0, int64_t x1, int64_t y1);
void fg_band_free(fg_band *band);

#endif
