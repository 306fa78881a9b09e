/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One round feature, or a straight stretch, while its edge is found (disc_edge.h), as the steps of
 * that share it. */
#ifndef FG_VISION_DISC_WORK_H
#define FG_VISION_DISC_WORK_H

#include <stdbool.h>

#include "foilgauge/picture.h"
#include "vision/disc_find.h"
#include "vision/driver_table.h"
#include "vision/ring.h"
#include "vision/step_model.h"

typedef struct fg_disc_station {
  float edge_px;  /* outwards from the circle */
  float u_px;     /* sd from pixel noise alone */
  float split_px; /* half of: what the flanks' pixels say minus what the core's say */
  float u_split_px;
  float weight;                /* 0: not usable; 1: good */
  float shape[FG_STEP_VALUES]; /* of its profile; the edge is not used */
  float m[2], g[2];            /* sums over pixels of the core and of the flanks */
  float misfit;
  int32_t used, seen;
} fg_disc_station;

typedef struct fg_disc_edge {
  fg_circle circle;          /* that edge_px is counted from */
  fg_disc_station *stations; /* around the turn, see fg_ring_angle; owned */
  size_t count;
  double inside, outside; /* levels, 8-bit counts */
  double blur_px, noise, gamma;
  double sector_rms_px; /* of the sectors' edges about the circle */
  fg_picture_state picture;
  double spread_px, asymmetry; /* vision/edge_spread.h */
  bool driven;                 /* a driver's model is in force */
  double level_u_px;           /* what all edge_px may be wrong by together: for the tone curve's
                                      doubt, and, where the scale ends at white, for light a tenth of
                                      the contrast beyond it */
} fg_disc_edge;

/* The tone curve, G(u) = 255 (u/255)^(1/gamma). */
typedef struct fg_tone {
  double gamma;
  double uncertainty;    /* standard deviation; INFINITY: not known */
  bool slopes;           /* a halo or a wall beside the edge may have made the asymmetry */
  double found, u_found; /* of a pool: the exponent before it is taken for 1; found 0: not known */
  bool plain;            /* counts are taken for the light, whatever the edge says */
  bool linear;           /* it is stated to be none; an unsharp mask may still be found */
} fg_tone;

/* One edge at work: around a feature, or a straight stretch (vision/line_edge.h), whose ring is
 * the band about it and whose turn is its length. */
typedef struct fg_disc_work {
  const fg_tiles *tiles;
  const fg_pixel_shape *shape;
  fg_ring ring;
  fg_profile_bin *bins; /* of all sectors */
  size_t bin_count;
  fg_step_fit *sectors; /* ring.sector_count */
  double gamma;
  bool linear;       /* the user vouches that counts are proportional to the light */
  fg_driver *driver; /* NULL: a power of the light, which is gamma, is all that it does; owned */
  fg_driver_tone *driver_tone;
  double u_driver_px; /* of an edge, outwards: what is left open of the driver */
  bool unexplained;   /* no driver's model explains the profiles */
  bool white[2];      /* inside, outside is at the end of the scale */
  bool open;          /* it does not close: stretches */
} fg_disc_work;

void fg_disc_work_free(fg_disc_work *work); /* what was collected and fitted */

/* Mean profiles of the collected pixels, and whether a side is white. disc_sectors.c */
fg_status fg_disc_stack_sectors(fg_context *ctx, fg_disc_work *work);

/* A step to each profile; `held` as in fg_step_fit. disc_sectors.c */
void fg_disc_fit_sectors(const fg_disc_work *work, unsigned held);

/* level_u_px of the edge, see above. */
double fg_disc_level_uncertainty(const fg_disc_work *work, const fg_tone *tone,
                                 const fg_disc_edge *edge);

/* The shape of every station from the sectors' fits. disc_shape.c */
fg_status fg_disc_smooth_shape(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge);

/* The tone curve from the sectors' profiles, which are fitted again for it. disc_tone.c */
fg_status fg_disc_find_tone(fg_context *ctx, fg_disc_work *work, fg_tone *tone);

/* Whether a slope (FG_STEP_SLOPE_IN or _OUT) is more than the sectors' own scatter. */
bool fg_disc_has_slope(const fg_disc_work *work, int value);

/* Driver model of the edge, where one step without it misses the sectors' profiles:
 * the sectors are fitted again with it. disc_driver.c */
fg_status fg_disc_find_driver(fg_context *ctx, fg_disc_work *work);

/* Driver model found at one edge, for another that tells too little of it itself. */
typedef struct fg_found_driver {
  bool found;
  fg_driver driver;
  double u_edge_px;
  bool unexplained;
} fg_found_driver;

fg_found_driver fg_disc_found_driver(const fg_disc_work *work);
fg_status fg_disc_take_driver(fg_context *ctx, fg_disc_work *work, const fg_found_driver *found);
void fg_disc_describe_driver(const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state);

/* A step's values in light as those of a driven profile. */
void fg_disc_driven_values(const fg_disc_work *work, const double *x, double *values);

/* Profiles of all stations, and one of them at a distance outwards from the edge; false beyond
 * what tells of the edge. disc_driven.c */
fg_status fg_disc_fill_tables(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                              fg_driven_tables *tables);
bool fg_disc_driven_at(const fg_disc_work *work, const fg_driven_tables *tables, size_t station,
                       const fg_disc_station *s, float d, float *model, float *by_edge);

/* The edge of every station with its shape held. disc_solve.c */
fg_status fg_disc_solve(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge);

#endif
