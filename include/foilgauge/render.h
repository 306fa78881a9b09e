/* The forward model: foils and a scanner in, a scan and its truth out.
 *
 * A spec is JSON with "schema": "foilgauge/render/1" (samples/render/ holds two to start from).
 * What is drawn is exact: the strip's midline is made of lines and arcs, a sample of the picture is
 * the blurred strip at its signed distance, and the picture is low-passed in two dimensions, so
 * that what blur does to a curved edge is really there. The same spec and seed give the same bytes,
 * whatever the height of the strips it is drawn in. Memory is proportional to a strip of rows.
 *
 * How a pixel comes about, in this order:
 *   coverage of the pixel's surroundings, at true position = nominal + d(x, y) of the effects;
 *   optical blur (Gaussian, sd `blur_px`) and the pixel's own square (1 px box, not counted in
 *   blur_px); halo; light = background + contrast × coverage, linear; shading; tone curve
 *   DN = 255 light^(1/gamma), where background and background + contrast keep their DN; noise;
 *   clipping; rounding to 8 or 16 bit (full scale 65535 = 255 × 257); JPEG blocks.
 *
 * Nothing here is shared with the measuring side.
 */
#ifndef FOILGAUGE_RENDER_H
#define FOILGAUGE_RENDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/circle.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_render_spec fg_render_spec;

/* What one bump really is (midline). theta by cos(theta) = (X² - R² - R0²) / (2 R R0). */
typedef struct fg_render_bump {
  int index;                     /* 1 is next to the lip */
  double radius_mm;              /* R */
  double bump_angle_deg;         /* alpha */
  double intersection_angle_deg; /* theta */
  double centre_to_centre_mm;    /* X */
  double height_mm;              /* h = R0 - (X - R) */
  fg_point centre_px;
  bool crushed;
} fg_render_bump;

typedef struct fg_render_foil {
  double overall_radius_mm;
  fg_point overall_centre_px;
  double thickness_mm;
  double rotate_deg; /* direction of the foil's middle seen from O, about the scan's x axis */
  bool mirror;       /* false: bump numbers rise clockwise as the scan is seen */
  const fg_render_bump *bumps; /* without the missing ones */
  size_t bump_count;
} fg_render_foil;

typedef struct fg_render_disc {
  fg_point centre_px;
  double radius_mm;
  bool hole;
} fg_render_disc;

/* What is drawn; owned by the spec. */
typedef struct fg_render_truth {
  int64_t width_px, height_px;
  int bits;
  double dpi[2]; /* x, y */
  const fg_render_foil *foils;
  size_t foil_count;
  const fg_render_disc *discs;
  size_t disc_count;
} fg_render_truth;

/* Takes a row of the picture: `pixels` are width_px values of 8 bit, or of 16 bit in host byte
 * order. Rows come in order. What it returns other than FG_OK ends the rendering. */
typedef fg_status fg_render_row(fg_context *ctx, void *user, int64_t row, const void *pixels);

/* Reads a spec; `path` is for messages. FG_ERR_DATA names the member, its value and what would be
 * right. On success the caller frees with fg_render_free. */
fg_status fg_render_parse(fg_context *ctx, const char *path, const char *json,
                          fg_render_spec **spec);
fg_status fg_render_load(fg_context *ctx, const char *path, fg_render_spec **spec);
void fg_render_free(fg_render_spec *spec); /* NULL is fine */

const fg_render_truth *fg_render_get_truth(const fg_render_spec *spec);

/* A point of a foil's true midline at arc length s_mm from its first end (the lip's), in pixels;
 * part effects are in it, scanner effects and edge roughness are not. `foil` counts from 0.
 * FG_ERR_USAGE when there is no such foil or place. */
fg_status fg_render_midline(fg_context *ctx, const fg_render_spec *spec, size_t foil, double s_mm,
                            fg_point *point_px);

/* Renders and hands out row after row. `strip_rows` is how many rows are drawn at a time (rounded
 * up to a multiple of 64); 0 is the default. It does not change the picture. */
fg_status fg_render_rows(fg_context *ctx, const fg_render_spec *spec, int64_t strip_rows,
                         fg_render_row *row, void *user);

/* Renders to a PNG file (gray, 8 or 16 bit, with pHYs) and, unless truth_path is NULL, writes the
 * truth as JSON ("schema": "foilgauge/truth/1"). Each appears only when whole. */
fg_status fg_render_scan(fg_context *ctx, const fg_render_spec *spec, const char *scan_path,
                         const char *truth_path);

/* The truth as JSON text; the caller frees it with free(). */
fg_status fg_render_truth_json(fg_context *ctx, const fg_render_spec *spec, char **json);

#ifdef __cplusplus
}
#endif
#endif
