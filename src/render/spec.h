/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A spec as read, and the scene that is made of it. */
#ifndef FG_RENDER_SPEC_H
#define FG_RENDER_SPEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/render.h"
#include "render/colour_lines.h"
#include "render/driver.h"
#include "render/jumps.h"
#include "render/spec_effects.h"

enum { FG_RENDER_BUMPS_MAX = 64, FG_RENDER_FOILS_MAX = 4096 };

/* Design members that the renderer needs (the same names as in a design file). */
typedef struct fg_render_design {
  bool arc;        /* kind "arc": a plain strip, bump_count 0 */
  bool cantilever; /* kind "cantilever": a flat sheet with beams, bump_count 0 */
  int bump_count;
  double bump_radius_mm, bump_angle_deg, overall_radius_mm, sleeve_radius_mm, pitch_deg;
  double fillet_radius_mm, thickness_mm, rotor_diameter_mm;
  double subtended_angle_deg; /* of an arc */
  int beam_count;             /* of a cantilever, as the following members */
  double beam_length_mm, beam_width_mm, sagitta_mm, clearance_mm; /* NaN: not stated */
} fg_render_design;

/* Mean and standard deviation of the deviation of length or width over the beams. */
typedef struct fg_beam_scatter {
  double mean_um, sd_um;
} fg_beam_scatter;

/* The beams of a cantilever. */
typedef struct fg_beams_request {
  bool slits; /* cut free inside a sheet by U-shaped slits; else a comb */
  double pitch_mm, base_mm, shoulder_mm, kerf_mm, corner_radius_mm, root_radius_mm;
  fg_beam_scatter length, width;
  double length_um[FG_RENDER_BUMPS_MAX],
      width_um[FG_RENDER_BUMPS_MAX];    /* deviations, added to the scattered ones */
  double taper_um[FG_RENDER_BUMPS_MAX]; /* root less free end */
  bool missing[FG_RENDER_BUMPS_MAX];
  double torn[FG_RENDER_BUMPS_MAX]; /* remaining share of the length; 1: whole */
  double bent_deg[FG_RENDER_BUMPS_MAX];
} fg_beams_request;

typedef struct fg_render_lip {
  double length_mm, bend_radius_mm;
  bool outwards;
} fg_render_lip;

typedef struct fg_foil_request {
  fg_render_design design;
  double overall_radius_mm;              /* actual; NaN: as designed */
  double subtended_angle_deg;            /* of an arc; NaN: its length stays, the radius changes */
  double springback_mean, springback_sd; /* R = R_D (1 + mean + sd × normal) */
  double radius_mm[FG_RENDER_BUMPS_MAX]; /* overrides; NaN: by springback */
  double bump_angle_deg[FG_RENDER_BUMPS_MAX]; /* NaN: constant arc length */
  double height_factor[FG_RENDER_BUMPS_MAX];  /* 1: not crushed */
  bool missing[FG_RENDER_BUMPS_MAX];
  bool has_lip;
  fg_render_lip lip;
  double first_land_mm, last_land_mm; /* from the fillet's end */
  double centre_mm[2];                /* NaN: placed automatically */
  double rotate_deg, rotate_step_deg;
  bool mirror;
  int repeat;
  fg_beams_request beams; /* of a cantilever */
} fg_foil_request;

typedef struct fg_disc_request {
  double centre_mm[2], radius_mm;
  bool hole;
  int lobes;
  double lobe_um, lobe_phase_deg; /* r = radius + lobe cos(lobes (phi - phase)) */
} fg_disc_request;

typedef enum fg_grid_marks {
  FG_GRID_DOTS,
  FG_GRID_CHESSBOARD,
  FG_GRID_CROSSES,
  FG_GRID_LINES
} fg_grid_marks;

enum { FG_GRID_MISSING_MAX = 64 };

/* A plate or board. `ratio`, `shear` and `scale` are its own errors: x over y, angle of its axes,
 * both axes; `place_um` the sd of its marks' places (not of a chessboard's corners). */
typedef struct fg_grid_request {
  fg_grid_marks marks;
  double pitch_mm, mark_mm, length_mm; /* diameter or width of strokes; their length */
  int columns, rows;
  double centre_mm[2], rotate_deg, ratio, shear, scale, place_um;
  int missing[FG_GRID_MISSING_MAX][2];
  size_t missing_count;
} fg_grid_request;

/* Objects on the glass, drawn at random places. Contrast in DN, either sign. */
typedef struct fg_litter {
  int count;
  double radius_px, length_px, contrast;
} fg_litter;

/* Light from one side: a band beside edges whose normal lies in a sector of directions. */
typedef struct fg_shadow {
  double amplitude; /* of the contrast; negative: darker. 0: none */
  double direction_deg, width_deg;
  double length_px, gap_px;
} fg_shadow;

typedef struct fg_scanner {
  double dpi[2];
  double sensor_dpi[2]; /* NaN: dpi; else the driver interpolates */
  bool bicubic;         /* the interpolation; else bilinear */
  int bits;
  double background, contrast, gamma, noise, noise_correlation, clip_white;
  double blur_px[2];     /* x, y; or along the ellipse's own axes */
  double blur_angle_deg; /* of its first axis, from x towards y */
  double motion_blur_px; /* along y: the carriage moves while a row is read */
  double shading[3];     /* relative, at the picture's edge: x, y, quadratic */
  fg_litter dust, specks, scratches;
  double one_sided_blur_px;
  int one_sided_way; /* +1: the carriage went along rising rows, -1: against them */
  double edge_roughness_um, edge_common_um, edge_correlation_um;
  bool edge_exponential; /* autocorrelation of the roughness: exponential; else Gaussian */
  double halo_fraction, halo_length_px;
  double wall_amplitude, wall_direction_deg, wall_length_px, wall_gap_px;
  fg_shadow shadow;
  int jpeg_quality; /* 0: none */
  fg_jump_requests jumps;
  fg_colour_lines colour;
  fg_driver_settings driver;
} fg_scanner;

/* A piece of a midline, in mm of true coordinates. Arc length runs from the lip to the free end. */
typedef struct fg_segment {
  bool line;
  bool open_start, open_end; /* the strip ends here */
  double x, y;               /* the arc's centre, or the begin of the line */
  double radius;
  double angle, sweep;    /* of the arc: its first angle and its signed turn */
  double ax, ay, bx, by;  /* arc: unit vectors from the centre to start and end;
                             line: unit tangent and unit normal towards the inner side */
  double mx, my;          /* arc: unit vector from the centre to the middle */
  double side;            /* +1: the inner side (towards the bearing) is outside the arc */
  double s_mm, length_mm; /* of the start; length along it */
  int bump;               /* from 1; 0 for others */
  int joins;              /* a fillet: -1 it ends, 1 it starts at the end u = -1, 1 of the bump */
  double bump_mm;         /* a fillet: length of that bump's arc */
  size_t foil;
} fg_segment;

typedef struct fg_drawn_foil {
  double x, y, axis_rad, mirror; /* O; direction of the middle; +1 or -1 */
  double half_span_rad, half_thickness_mm, length_mm;
  size_t first_segment, segment_count;
  float *roughness[2]; /* inner and outer edge, shift to the inner side in mm; NULL: none */
  size_t roughness_count;
  double roughness_step_mm;
  bool rough_cuts; /* the ends of an arc are as rough as its edges */
  float *cut[2];   /* at its start and end, across, outwards, mm; NULL: none */
  size_t cut_count;
  bool sheet; /* no strip: its segments are the outlines of a flat part, its thickness is 0 */
} fg_drawn_foil;

/* Discs, dust and scratches: a capsule, or a circle with lobes. */
typedef struct fg_shape {
  double x0, y0, x1, y1, radius; /* mm, true coordinates */
  double value;                  /* coverage inside it, or the addition to it */
  bool adds;
  int lobes;
  double lobe_mm, lobe_phase_rad;
  float *roughness; /* outwards, mm, at equal angles from that of x; NULL: none */
  size_t roughness_count;
  fg_point normal[2]; /* of a square: of its sides */
  double half_mm[2];  /* distance of its sides from its middle; 0: no square */
} fg_shape;

typedef struct fg_scene {
  fg_segment *segments;
  size_t segment_count, segment_capacity;
  fg_drawn_foil *drawn;
  fg_render_foil *foils;
  size_t foil_count;
  fg_shape *shapes;
  size_t shape_count;
  fg_render_disc *discs;
  size_t disc_count;
  fg_render_mark *marks;
  size_t mark_count;
} fg_scene;

/* Grid of the sensor; the finished picture's own, unless the driver resamples. */
typedef struct fg_sensor_grid {
  double pixel_mm[2];
  int64_t width_px, height_px;
} fg_sensor_grid;

struct fg_render_spec {
  fg_scanner scanner;
  fg_render_effect_list effects;
  uint64_t seed;
  double width_px, height_px, margin_px; /* NaN: fitted */
  fg_foil_request *requests;
  size_t request_count;
  fg_disc_request *disc_requests;
  size_t disc_request_count;
  fg_grid_request *grid_requests;
  size_t grid_request_count;
  double pixel_mm[2]; /* of the finished picture */
  fg_sensor_grid sensor;
  fg_scene scene;
  fg_render_truth truth;
};

/* Streams of random numbers: one per purpose, so that a change in one does not change the others.
 */
typedef enum fg_random_stream {
  FG_STREAM_SPRINGBACK = 1,
  FG_STREAM_PLACE,
  FG_STREAM_DUST,
  FG_STREAM_SPECKS,
  FG_STREAM_SCRATCHES,
  FG_STREAM_ROUGHNESS,
  FG_STREAM_NOISE,
} fg_random_stream;

/* Makes segments, shapes, size and truth of the requests. */
fg_status fg_scene_build(const fg_place *place, fg_render_spec *spec);
void fg_scene_free(fg_scene *scene);

/* Numbers of shapes and marks of all grids; builds them behind the discs, and extends `reach`, the
 * lowest and highest x and y of all drawings. */
size_t fg_grids_shapes(const fg_render_spec *spec);
size_t fg_grids_marks(const fg_render_spec *spec);
fg_status fg_grids_build(const fg_place *place, fg_render_spec *spec, double reach[2][2]);

int fg_scene_max_bumps(const fg_render_spec *spec); /* of any foil, as designed */

/* Point at distance t along a segment. */
fg_point fg_segment_point(const fg_segment *segment, double t_mm);

/* Point of the part as it is at distance t along a segment: with the part's effects, without those
 * of the edges that a scanner makes. */
fg_point fg_segment_part_point(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                               const fg_segment *segment, double t_mm);

/* Direction of a place about O, from the foil's middle towards its free end. */
double fg_foil_psi(const fg_drawn_foil *drawn, double x_mm, double y_mm);

/* Shift of a bump's arc by its effects, towards the inner side, mm; on a fillet that joins it, the
 * shift's fading. */
double fg_segment_bump_shift(const fg_render_effect_list *effects, const fg_segment *segment,
                             double t_mm);

/* Appends the segments of one foil in its own coordinates (O at the origin, the middle along x,
 * bump numbers along rising angle). Fills its bumps (places in mm, in the same coordinates) and its
 * drawing data. */
fg_status fg_outline_build(const fg_place *place, const fg_render_spec *spec,
                           const fg_foil_request *request, fg_scene *scene, size_t foil);

/* Appends a segment that begins at *s_mm, the end of the segments before it, and advances *s_mm. */
fg_status fg_scene_append(fg_context *ctx, fg_scene *scene, size_t foil, double *s_mm,
                          fg_segment segment);

/* Appends the outlines of a cantilever's sheet in its own coordinates (the middle of the roots at
 * the origin, beams along x, their numbers along rising y). */
fg_status fg_sheet_build(const fg_place *place, const fg_render_spec *spec,
                         const fg_foil_request *request, fg_scene *scene, size_t foil);

/* Fills the measurand of one foil and its bumps (measurand.c). */
fg_status fg_measurand_build(fg_context *ctx, fg_render_spec *spec, size_t foil);

/* Returns X, theta and h of a bump as designed. */
fg_render_bump fg_outline_nominal(const fg_render_design *design);

/* Draws the random deviation of the edges of one foil, if the scanner has any. */
fg_status fg_roughness_build(fg_context *ctx, const fg_render_spec *spec, size_t foil,
                             fg_drawn_foil *drawn);
fg_status fg_roughness_build_disc(fg_context *ctx, const fg_render_spec *spec, size_t disc,
                                  fg_shape *shape);

/* Catmull-Rom between drawn values, from the second to the last but one. */
double fg_roughness_at(const float *values, double place);

#endif
