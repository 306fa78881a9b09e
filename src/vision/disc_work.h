/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of one round feature, or of a straight stretch, during the search of its edge
 * (disc_edge.h), shared by its steps. */
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
  float split_px; /* half of: edge by the flanks' pixels minus edge by the core's */
  float u_split_px;
  float weight;                /* 0: not usable; 1: good */
  float shape[FG_STEP_VALUES]; /* of its profile; FG_STEP_EDGE is not used */
  float m[2], g[2];            /* sums over pixels of the core and of the flanks */
  float misfit;
  int32_t used, seen;
} fg_disc_station;

typedef struct fg_disc_edge {
  fg_circle circle;          /* zero of edge_px */
  fg_disc_station *stations; /* around the turn, see fg_ring_angle; owned */
  size_t count;
  double inside, outside; /* levels, 8-bit counts */
  double blur_px, noise, gamma;
  double shape_ratio;   /* see fg_step_fit; of the typical sector */
  double sector_rms_px; /* of the sectors' edges about the circle */
  fg_picture_state picture;
  double spread_px, asymmetry; /* vision/edge_spread.h */
  bool driven;                 /* a driver's model is in force */
  double
      level_u_px; /* uncertainty common to all edge_px. Sources: the tone curve's uncertainty, and,
                     where the scale ends at white, light of a tenth of the contrast beyond it */
} fg_disc_edge;

/* The tone curve, G(u) = 255 (u/255)^(1/gamma). */
typedef struct fg_tone {
  double gamma;
  double uncertainty; /* standard deviation; INFINITY: not known */
  bool slopes;        /* the asymmetry may come from a halo or a wall beside the edge */
  double found,
      u_found; /* of a pool: the exponent before it is replaced by 1; found 0: not known */
  bool plain;  /* counts are used as light, whatever the edge shows */
  bool linear; /* the user states that there is no tone curve; an unsharp mask may still be found */
} fg_tone;

/* One edge in work: around a feature, or a straight stretch (vision/line_edge.h). The ring of a
 * stretch is the band about it, its turn is the stretch's length. */
typedef struct fg_disc_work {
  const fg_tiles *tiles;
  const fg_pixel_shape *shape;
  fg_ring ring;
  fg_profile_bin *bins; /* of all sectors */
  size_t bin_count;
  fg_step_fit *sectors; /* ring.sector_count */
  double gamma;
  double blur_px;    /* as known; 0: it is fitted */
  bool linear;       /* the user states that counts are proportional to the light */
  fg_driver *driver; /* NULL: the power gamma of the light describes the driver fully; owned */
  fg_driver_tone *driver_tone;
  double u_driver_px; /* of an edge, outwards: from the driver's uncertainty */
  bool unexplained;   /* no driver's model explains the profiles */
  bool white[2];      /* inside, outside: level at the end of the scale */
  bool open;          /* a stretch, which does not close */
} fg_disc_work;

void fg_disc_work_free(fg_disc_work *work); /* frees pixels, profiles and fits */

/* Fills the mean profiles of the collected pixels, and white[]. disc_sectors.c */
fg_status fg_disc_stack_sectors(fg_context *ctx, fg_disc_work *work);

/* Fits a step to each profile; `held` as in fg_step_fit. disc_sectors.c */
void fg_disc_fit_sectors(const fg_disc_work *work, unsigned held);

/* Returns level_u_px of the edge, see above. */
double fg_disc_level_uncertainty(const fg_disc_work *work, const fg_tone *tone,
                                 const fg_disc_edge *edge);

/* Fills the shape of every station from the sectors' fits. disc_shape.c */
fg_status fg_disc_smooth_shape(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge);

/* Finds the tone curve from the sectors' profiles, and fits these again with it. disc_tone.c */
fg_status fg_disc_find_tone(fg_context *ctx, fg_disc_work *work, fg_tone *tone);

/* Returns true when a slope (FG_STEP_SLOPE_IN or _OUT) exceeds the sectors' own scatter. */
bool fg_disc_has_slope(const fg_disc_work *work, int value);

/* Finds the driver's model, where one step without it does not explain the sectors' profiles, and
 * fits the sectors again with it. disc_driver.c */
fg_status fg_disc_find_driver(fg_context *ctx, fg_disc_work *work);

/* Driver model found at one edge, for another that tells too little of the driver. */
typedef struct fg_found_driver {
  bool found;
  fg_driver driver;
  double u_edge_px;
  bool unexplained;
} fg_found_driver;

fg_found_driver fg_disc_found_driver(const fg_disc_work *work);
fg_status fg_disc_use_driver(fg_context *ctx, fg_disc_work *work, const fg_found_driver *found);
void fg_disc_describe_driver(const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state);

/* Converts a step's values in light to those of a driven profile. */
void fg_disc_driven_values(const fg_disc_work *work, const double *x, double *values);

/* Tables of all stations' profiles, and the value of one at a distance outwards from the edge;
 * false too far from the edge to depend on its place. disc_driven.c */
fg_status fg_disc_fill_tables(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                              fg_driven_tables *tables);
bool fg_disc_driven_at(const fg_disc_work *work, const fg_driven_tables *tables, size_t station,
                       const fg_disc_station *s, float d, float *model, float *by_edge);

/* Solves for the edge of every station with its shape held. disc_solve.c */
fg_status fg_disc_solve(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge);

#endif
