/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forward model: foils and a scanner in, a scan and its truth out.
 *
 * A spec is JSON with "schema": "foilgauge/render/1" (samples/render/ holds specs to start from).
 * The drawing is exact: the strip's midline is made of lines and arcs, a sample of the picture is
 * the blurred strip at its signed distance, and the picture is low-passed in two dimensions, so
 * that the effect of blur on a curved edge is real. The same spec and seed give the same bytes,
 * whatever the height of the strips it is drawn in. Memory is proportional to a strip of rows.
 *
 * How a pixel comes about, in this order:
 *   coverage of the pixel's surroundings, at true position = nominal + d(x, y) of the effects;
 *   optical blur (Gaussian, sd `blur_px`) and the pixel's own square (1 px box, not counted in
 *   blur_px); halo; light = background + contrast × coverage, linear; shading; tone curve
 *   DN = 255 light^(1/gamma), where background and background + contrast keep their DN; noise;
 *   clipping; interpolation from the sensor's resolution; tone_curve; rounding to 8 or 16 bit
 *   (full scale 65535 = 255 × 257); unsharp_mask; levels; JPEG blocks.
 *
 * Members of a spec (default in brackets; lengths in mm of the midline, unless the name says else):
 *   seed [0], width_px, height_px [fitted to the content], margin_px [80], comment
 *   foils[] [one Gen II foil]:
 *     design {bump_radius_mm, bump_angle_deg, bump_count, overall_radius_mm, pitch_deg,
 *       fillet_radius_mm, thickness_mm ... as in a design file} [Gen II]; with "form": "sinusoidal"
 *       there is no lip unless one is given; with "form": "arc" a plain strip of
 *       overall_radius_mm, subtended_angle_deg [110] and thickness_mm, without one as well
 *     overall_radius_mm: R0 as it is [as designed]
 *     subtended_angle_deg: of an arc as it is [its length as designed]
 *     radius_springback {mean [0], sd [0]}: R = R_D (1 + mean + sd × normal);
 *     radius_mm [...] per bump instead; bump_angle_deg [...] per bump [R alpha as designed]
 *     lip null or {length_mm [2], bend_radius_mm [0.4], side ["outwards"]}
 *     first_land_mm [1.8], last_land_mm [1.3]: from the fillet to the lip's bend, or the free end
 *     missing [numbers]; crushed [{bump, height_factor [0.5]}]: crossings stay, the crown gives way
 *     beams, of a design with "form": "cantilever" (beam_count [8], beam_length_mm [9],
 *       beam_width_mm [3], thickness_mm; a flat sheet) and of no other: layout "comb" or "slits"
 *       ["comb"]: beams that stand out from a base, or that U-shaped slits cut free inside a sheet;
 *       pitch_mm [1.5 widths], base_mm [4] behind the roots (of slits beyond the free ends, too),
 *       shoulder_mm [2] beside the outer beams, kerf_mm [0.2] of slits, whose ends are round,
 *       corner_radius_mm [0.1] of the free ends and the sheet, root_radius_mm [0.3] of a comb's
 *       fillets; length, width {mean_um [0], sd_um [0]}: normal, over the beams; length_um,
 *       width_um [...] per beam, on top; taper_um: width at the root less that at the free end, one
 *       number or one per beam; missing [numbers]; torn [{beam, length_factor [0.5]}];
 *       bent [{beam, angle_deg [2]}]: in the sheet's plane, about the root
 *     rotate_deg [-90]: direction of the middle from O (x right, y down), of a cantilever from the
 *     roots to the free ends; mirror [false];
 *     centre_mm [x, y] of O [placed on shelves from the top]; repeat [1], rotate_step_deg [0]
 *   discs[]: centre_mm, radius_mm, hole [false], lobes [0], lobe_um, lobe_phase_deg:
 *     r = radius + lobe cos(lobes (phi - phase)); later ones lie on top
 *   grids[]: marks "dots", "chessboard", "crosses" or "lines", centre_mm, pitch_mm [5], columns [10],
 *     rows [10; of lines 1], mark_mm: a dot's diameter [half the pitch] or a stroke's width [0.08
 *     pitches], length_mm of a cross's stroke [0.6 pitches] or a line [4], rotate_deg [0], missing
 *     [[column, row], ...]; errors of the board's own: scale [0], ratio [0] of x over y, shear [0],
 *     place_um [0]: sd of every mark's place. Columns and rows of a chessboard are its corners'
 *   scanner:
 *     dpi [4800] or [x, y], bits [8], background [30], contrast [175; negative: dark on light],
 *     gamma [1], blur_px [1.2] or [x, y] [at least 0.4, and that of the coarser axis in mm],
 *     blur_angle_deg [0]: the two are along the axes of an ellipse, the first at this angle from x
 *     (right) towards y (down); noise [1 DN], noise_correlation [0] to the next pixel along x
 *     and y, clip_white, shading {x, y, quadratic}: relative, at the picture's edges
 *     dust, specks, scratches {count [0], radius_px, length_px, contrast}
 *     shadow {amplitude, direction_deg [0], width_deg [90], length_px [15], gap_px [0]}: a band
 *       beside edges (of foils, discs and holes) whose normal, out of the material, lies near the
 *       direction: its share is 1 there, 1/2 at half the width, nothing from the width on. Light in
 *       shares of the contrast, negative: darker. From the gap on it decays over the length
 *     resampled_from_dpi, one number or [x, y]: what the sensor reads where that is less than dpi;
 *       the driver interpolates, resampled_by "bilinear" or "bicubic" (Catmull-Rom) ["bilinear"],
 *       before its tone curve. What optics, sensor and carriage do (blur, halo, shadow, noise,
 *       colour lines, lost rows) is then in the sensor's pixels, everything else in the picture's
 *     the driver's stages, each channel by itself:
 *       tone_curve [[in, out], ...]: 2 to 256 points in counts of 255, in ascending, out not
 *         falling; straight between points, constant beyond them; tone_bits [not rounded], 8 to 16:
 *         to which the numbers are rounded before: 8 leave gaps in the histogram of 8 bits
 *       unsharp_mask {amount_pct, radius_px [1], threshold [0]}: out = in + amount (in -
 *         gaussian(in)) where the two differ by the threshold at least, on the rounded numbers and
 *         clipped to the scale; the Gaussian's sd is the radius, the outermost pixels go on beyond
 *         the picture
 *       levels [all]: the number of gray levels, which divide the scale evenly; 2 are one bit, at
 *         threshold [127.5 of 255]: white from there on
 *     rows_lost[] {y_mm, count}: behind that place of the picture `count` rows of the glass were
 *       never read; negative: the carriage stood still, and the row before it is seen as often
 *       again (its noise is new). Whole rows, sharp; the truth has it as scan.row_step of count
 *       × the rows' pitch, half a row before the first row beyond it
 *     stitches[] {y_mm, rows [0], shift_um [0]}: two pieces of a scan meet there: behind it the
 *       picture goes on `rows` rows further on (negative: the rows before it come a second time),
 *       seen at true = nominal + shift along x. In the truth as scan.row_step, with amplitude_x_um
 *     chip_seams[] {x_mm, shift_um, shift_y_um [0]}: what lies behind a seam between two chips of a
 *       contact image sensor is seen at true = nominal + shift; seams add up from left to right.
 *       The truth has each as scan.column_step, with amplitude_y_um where it shifts along y
 *     colour_lines: makes it a colour scan; each member has a number for red, green and blue:
 *       gap_px [0]: rows by which the line lies ahead: at row y it has the carriage's errors of
 *         y + gap, the gap itself being taken out as a scanner does it; dx_px, dy_px [0]: by which
 *         it shows everything further right and down; magnification_ppm [0]: along x about the
 *         picture's middle; background, contrast [as above; contrast may be 0]. Noise is each
 *         line's own; the truth has the course along y of red and blue against green
 *     rough:
 *       one_sided_blur_px [0]: blur added (in squares) to edges that go from bright to dark along
 *         the carriage's way, in proportion to the edge normal's share along it; one_sided_way
 *         ["+y"] or "-y": a scan of the same part turned by 180° has the other
 *       motion_blur_px [0]: length along y over which a row is read while the carriage moves
 *       edge_roughness_um, edge_common_um [0]: sd per edge, and of both together, along the strip
 *         with the correlation_um [50; 0.2 to 1e5] L and the correlation_form "gaussian",
 *         exp(-(d / L)²), or "exponential", exp(-d / L) ["gaussian"]. The sd is that of the edge
 *         itself: blur takes its share of finer scatter. A disc's edge and that of a
 *         cantilever have both sds
 *       halo {fraction, length_px}: that share of the light goes to two Gaussians, 0.6 and 1.6 L
 *       side_wall {amplitude, direction_deg, length_px, gap_px}: a band (negative: a shadow) beside
 *         edges that face the direction, decaying over the length, times the cosine to it
 *       jpeg {quality}: the finished picture, after all the driver did, as JPEG leaves it; 8 bit.
 *         Colours as luminance and colour differences of half the resolution (4:2:0)
 *   effects[] {id, parameters}: src/render/spec_effects.c holds the table. Free-form curves have
 *     knots [[coordinate, um], ...]: 2 to 64, ascending; natural cubic spline, constant beyond:
 *     free.scan.x, free.scan.y: mm; moves "x" or "y" [the coordinate's]; at most 100 um per mm
 *     free.foil.s: radial, over psi / half span; free.bump.phi: away from C, over u; beyond u = -1
 *     and 1 the fillets fade it out
 *     free.bump.index: no knots, but single bumps by their number: amplitude_um with bumps [3, 5],
 * or every 3 [first: every], or period_bumps with phase_deg [0] (amplitude sin(2 pi number / period
 *     + phase)); or values_um [...] from bump 1. form "crown": the arc's middle rises by that much
 *     towards the bearing's middle and falls off as (1 - u²)², its ends and the circle of the truth
 *     stay; "whole": the circle moves there as it is, the fillets follow, and X, h, alpha and theta
 *     of the truth are those of the raised bump ["crown"]
 *     free.edge.normal: degrees of the direction to the strip's inner side in the scan, closed over
 *     360; edges "together" (to that side) or "apart" (away from each other) ["together"]
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

/* The least-squares circle through an arc, or all lands, of the part as it is: with its effects,
 * without those of the scanner. Where nothing deforms the part it is the ideal circle. */
typedef struct fg_render_measurand {
  double radius_mm; /* NaN: too short for a circle */
  fg_point centre_px;
  double form_error_um; /* peak-to-valley deviation from that circle */
  /* X, h, alpha and theta of a bump, of its circle and that of the lands. */
  double centre_to_centre_mm, height_mm, bump_angle_deg, intersection_angle_deg;
} fg_render_measurand;

/* True values of one bump (midline), before part effects move it. theta by cos(theta) = (X² - R² -
 * R0²) / (2 R R0). */
typedef struct fg_render_bump {
  int index;                     /* 1 is next to the lip */
  double radius_mm;              /* R */
  double bump_angle_deg;         /* alpha */
  double intersection_angle_deg; /* theta */
  double centre_to_centre_mm;    /* X */
  double height_mm;              /* h = R0 - (X - R) */
  fg_point centre_px;
  bool crushed;
  fg_render_measurand measurand;
} fg_render_bump;

/* True values of one beam of a cantilever. Its length runs from the line of the roots (a comb's
 * base, the ends of the slits) to the free end, along the beam; its width is measured half way. */
typedef struct fg_render_beam {
  int number; /* from 1; in order along y where the beams point along x */
  double length_mm, width_mm;
  double taper_um;          /* width at the root less that at the free end */
  double bent_deg;          /* in the sheet's plane, about the root */
  bool torn;                /* length_mm is the mean of the remainder */
  fg_point root_px, tip_px; /* on its middle line */
} fg_render_beam;

typedef struct fg_render_foil {
  double overall_radius_mm;   /* NaN of a cantilever */
  fg_point overall_centre_px; /* of a cantilever the middle of the line of the roots */
  double thickness_mm;
  double subtended_angle_deg; /* of an arc; 0: it has bumps */
  double rotate_deg; /* direction of the foil's middle seen from O, or of a cantilever's beams,
                        about the scan's x axis */
  bool mirror;       /* false: bump numbers rise clockwise as the scan is seen */
  fg_render_measurand measurand; /* of the lands; not of a cantilever */
  const fg_render_bump *bumps;   /* without the missing ones */
  size_t bump_count;
  const fg_render_beam *beams; /* of a cantilever, without the missing ones; else NULL */
  size_t beam_count;
} fg_render_foil;

typedef struct fg_render_disc {
  fg_point centre_px;
  double radius_mm;
  bool hole;
} fg_render_disc;

/* A mark of a grid, at its true place. */
typedef struct fg_render_mark {
  size_t grid; /* from 1 */
  int column, row;
  fg_point centre_px;
} fg_render_mark;

/* Content of the picture; owned by the spec. */
typedef struct fg_render_truth {
  int64_t width_px, height_px;
  int bits;
  int channels;  /* 1; 3: red, green, blue */
  double dpi[2]; /* x, y */
  const fg_render_foil *foils;
  size_t foil_count;
  const fg_render_disc *discs;
  size_t disc_count;
  const fg_render_mark *marks;
  size_t mark_count;
} fg_render_truth;

/* Receives a row of the picture: `pixels` are width_px × channels values of 8 bit, or of 16 bit in
 * host byte order. Rows come in order. A return other than FG_OK ends the rendering. */
typedef fg_status fg_render_row(fg_context *ctx, void *user, int64_t row, const void *pixels);

/* Reads a spec; `path` is for messages. FG_ERR_DATA names the member, its value and the allowed
 * values. On success the caller frees with fg_render_free. */
fg_status fg_render_parse(fg_context *ctx, const char *path, const char *json,
                          fg_render_spec **spec);
fg_status fg_render_load(fg_context *ctx, const char *path, fg_render_spec **spec);
void fg_render_free(fg_render_spec *spec); /* NULL is fine */

const fg_render_truth *fg_render_get_truth(const fg_render_spec *spec);

/* Returns a point of a foil's true midline at arc length s_mm from its first end (the lip's), in
 * pixels. It includes part effects, but not scanner effects and edge roughness. `foil` counts from
 * 0. FG_ERR_USAGE when there is no such foil or place, and for a cantilever. */
fg_status fg_render_midline(fg_context *ctx, const fg_render_spec *spec, size_t foil, double s_mm,
                            fg_point *point_px);

/* Renders and hands out row after row. `strip_rows` is the number of rows drawn at a time (rounded
 * up to a multiple of 64); 0 is the default. It does not change the picture. */
fg_status fg_render_rows(fg_context *ctx, const fg_render_spec *spec, int64_t strip_rows,
                         fg_render_row *row, void *user);

/* Renders to a PNG file (gray or RGB, 8 or 16 bit, with pHYs) and, unless truth_path is NULL,
 * writes the truth as JSON ("schema": "foilgauge/truth/1"). Each appears only when complete. */
fg_status fg_render_scan(fg_context *ctx, const fg_render_spec *spec, const char *scan_path,
                         const char *truth_path);

/* Writes the truth as JSON text; the caller frees it with free(). */
fg_status fg_render_truth_json(fg_context *ctx, const fg_render_spec *spec, char **json);

#ifdef __cplusplus
}
#endif
#endif
