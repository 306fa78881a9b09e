/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Driver stages, applied to the sensor's numbers: tone curve, unsharp mask, gray levels; and JPEG.
 *
 * The tone curve bends the sensor's number, with its noise, before it is rounded to the bits of the
 * scan. The later stages work on rounded numbers, as in drivers. */
#ifndef FG_RENDER_DRIVER_H
#define FG_RENDER_DRIVER_H

#include "foilgauge/render.h"
#include "render/jpeg.h"
#include "render/members.h"

enum { FG_TONE_POINTS_MAX = 256, FG_TONE_COUNTS = 256 };

/* Piecewise linear curve, constant beyond its points. Counts of 8 bit. */
typedef struct fg_tone_curve {
  size_t count; /* 0: none */
  int bits;     /* of its input; 0: input is not rounded */
  double in[FG_TONE_POINTS_MAX], out[FG_TONE_POINTS_MAX];
  size_t first[FG_TONE_COUNTS]; /* the last point at or below a whole count */
} fg_tone_curve;

/* out = in + amount (in - blurred), where the two differ by at least the threshold. */
typedef struct fg_unsharp_mask {
  double amount_pct; /* 0: none */
  double radius_px;  /* sd of the Gaussian */
  double threshold;  /* counts of 8 bit */
} fg_unsharp_mask;

typedef struct fg_driver_settings {
  fg_tone_curve tone;
  fg_unsharp_mask unsharp;
  int levels;       /* 0: all of the scan's bits */
  double threshold; /* of two levels; NaN: half way */
} fg_driver_settings;

/* Reads members tone_curve, tone_bits, unsharp_mask, levels and threshold of the scanner of a spec
 * with `bits` bits. */
fg_status fg_driver_read(const fg_place *place, const cJSON *scanner, int bits,
                         fg_driver_settings *settings);

/* Value of a curve that has points. */
float fg_tone_curve_value(const fg_tone_curve *tone, float count);

/* Receiver of finished rows of rounded numbers. */
typedef struct fg_driver_picture {
  int64_t width, height;
  int channels;
  bool wide;        /* 16 bit */
  int jpeg_quality; /* 0: none */
} fg_driver_picture;

typedef struct fg_driver {
  const fg_driver_settings *settings;
  fg_driver_picture picture;
  fg_render_row *row; /* receives finished rows */
  void *user;
  int64_t taken, given;      /* rows */
  int taps;                  /* of the unsharp mask's Gaussian, each side of the centre */
  int64_t kept;              /* rows needed at once */
  float *kernel, *line;      /* `line` has room for the taps on both sides */
  float *numbers, *smoothed; /* rings of rows, channel after channel; along the row only */
  float *blurred;            /* one row */
  void *sharpened;           /* one row */
  uint8_t *block;            /* rows for JPEG */
  fg_jpeg jpeg;
} fg_driver;

fg_status fg_driver_create(fg_context *ctx, const fg_driver_settings *settings,
                           const fg_driver_picture *picture, fg_render_row *row, void *user,
                           fg_driver *driver);
void fg_driver_free(fg_driver *driver);

/* Accepts the next row, whose pixels it may change, and hands out the finished rows. The last row
 * hands out all. */
fg_status fg_driver_add_row(fg_context *ctx, fg_driver *driver, void *pixels);

#endif
