/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of one strip during the search of its edges (edges.h), shared by its steps. */
#ifndef FG_VISION_EDGE_WORK_H
#define FG_VISION_EDGE_WORK_H

#include <math.h>

#include "foilgauge/picture.h"
#include "foilgauge/strip.h"
#include "vision/driver_model.h"
#include "vision/edge_model.h"
#include "vision/pixel_band.h"
#include "vision/segment.h"
#include "vision/trace.h"

/* One station in work. */
typedef struct fg_edge_station {
  float middle_px;        /* centre of the strip, from the reference line */
  float edge_px[2];       /* left and right, from the reference line */
  float plateau, step[2]; /* P, and b - P */
  float slope[2], blur_px[2];
  float m11, m12, m22, g1, g2, misfit; /* sums over pixels */
  int32_t used, seen;
  float u_px[2];
  float weight;
  unsigned facts; /* fg_station_fact */
} fg_edge_station;

/* Reach of an edge, in blurs: pixels beyond it do not depend on the edge's place. */
#define FG_REACH_BLURS 4.0

/* Max distance of neighbouring counts. Counts farther apart make a staircase of an edge's profile,
 * which noise of a count or two does not smooth. */
#define FG_LEVEL_STEP_MAX 5.0

/* Stations are worked on in chunks, each with its own pixels; a chunk is a unit of parallel work,
 * its size is fixed, so sums do not depend on the number of threads. A segment is the stretch of
 * one mean profile. */
enum {
  FG_SEGMENT_STATIONS = 64,
  FG_CHUNK_SEGMENTS = 6,
  FG_CHUNK_STATIONS = FG_SEGMENT_STATIONS * FG_CHUNK_SEGMENTS
};

/* A mean profile and its fit. */
typedef struct fg_segment_profile {
  fg_profile_bin *bins;
  fg_profile_fit fit;
  bool wall[2]; /* a wall shows beside this edge, or it is not known whether */
} fg_segment_profile;

/* One strip in work: its pixels, stations and segments, and their common values. */
typedef struct fg_edge_work {
  const fg_tiles *tiles;
  const fg_segmentation *segmentation;
  const fg_trace *trace;
  const fg_reference *reference;
  unsigned threads;
  size_t chunk_count;
  fg_pixel_band *bands;      /* chunk_count */
  bool borrowed;             /* the bands are those of another measurement, and filled */
  fg_edge_station *stations; /* reference->count */
  fg_segment_profile *segments;
  fg_profile_bin *bins; /* segment_count × bin_count */
  size_t segment_count, bin_count;
  size_t good_segments; /* number of segments whose profile could be fitted */
  fg_edge_tables *tables;
  double width_px; /* of the strip */
  double reach_px; /* of the band beyond the strip's edges */
  double noise;    /* sd of a pixel, counts */
  double contrast; /* |P - b|, counts */
  bool clipped, side_band;
  double outer_px; /* reach of the model beside the edges of a foil whose wall shows; 0: no wall */
  bool linear;     /* gamma is 1, as the user states */
  double thickness_px, blur_px[2];
  double gamma, u_gamma;
  double
      tone_px; /* change of the thickness per unit of ln gamma at constant counts of all levels */
  bool bright; /* the strip is brighter than its background */
  fg_driver *driver; /* NULL: the power gamma of the light describes the driver fully */
  fg_driver_tone *driver_tone;
  double u_driver_px; /* of an edge, outwards: from the driver's uncertainty; NaN: no driver was
                         sought */
  double level_step;  /* mean distance of the counts in use */
  bool unexplained;   /* no driver's model explains the profiles */
  bool plain;         /* counts are used as light, whatever the profiles show */
  bool fitted;        /* the segments are fitted: this work goes on from another's */
  bool keeps_start;   /* `start` is wanted */
  struct fg_edge_work *start; /* this work before a driver was sought, where gamma was 1; or NULL */
  int round;                  /* number of the round of Gauss-Newton */
  bool again; /* second pass, stations are known: foreign pixels beside the strip are left out of
                 the shape */
} fg_edge_work;

/* Returns the reach of the model beside the edges: INFINITY where no wall shows. */
static inline float fg_edges_outer(const fg_edge_work *work) {
  return work->outer_px > 0 ? (float)work->outer_px : INFINITY;
}

/* Stations [*first, *last] of a chunk. edges_pixels.c */
void fg_edges_chunk(const fg_edge_work *work, size_t chunk, size_t *first, size_t *last);

/* Returns the background's count at a station. edges_pixels.c */
float fg_edges_background(const fg_edge_work *work, const fg_reference_station *station);

/* Collects the pixels of all chunks, and the middle of each station, smoothed over its neighbours.
 * edges_pixels.c */
fg_status fg_edges_collect(fg_context *ctx, fg_edge_work *work);

/* Steps 1 and 2: finds the tone curve and the shape of every station from its middle.
 * edges_shape.c, edges_smooth.c */
fg_status fg_edges_find_shape(fg_context *ctx, fg_edge_work *work);

/* Finds the sides of segments beside which a wall shows, and with them work->outer_px. edges_wall.c
 */
fg_status fg_edges_find_walls(fg_context *ctx, fg_edge_work *work);

/* Bins of a segment within the model's reach. */
void fg_edges_reach(const fg_edge_work *work, const fg_segment_profile *segment, size_t *first,
                    size_t *count);

/* Finds the driver's model where the plain model misses the segments' profiles. *found: segments
 * are to be fitted again. edges_driver.c */
fg_status fg_edges_find_driver(fg_context *ctx, fg_edge_work *work, bool *found);
void fg_edges_free_driver(fg_edge_work *work);

/* Fits a segment with work->driver held; segment->fit holds the start. */
fg_status fg_edges_fit_driven(fg_context *ctx, const fg_edge_work *work,
                              fg_segment_profile *segment);

/* Counts of light, and light of counts, under any driver, before its unsharp mask. */
double fg_edges_count(const fg_edge_work *work, double light, double *rate);
double fg_edges_light(const fg_edge_work *work, double count);

/* Fills the findings of tone curve and unsharp mask. */
void fg_edges_describe_driver(const fg_edge_work *work, fg_picture_state *state);

/* Smooths the shape of every station from the segments' fits; with `local` it adds the part of each
 * segment's own shape that is more than chance. */
fg_status fg_edges_smooth_shape(fg_context *ctx, fg_edge_work *work, bool local);

/* Marks stations where something lies on or beside the strip; they lose their weight. *found:
 * number of stations that lost it. edges_disturbed.c */
fg_status fg_edges_drop_disturbed(fg_context *ctx, fg_edge_work *work, size_t *found);

/* Names the kind of each disturbance: facts of the stations, and of the strip in *facts.
 * edges_defects.c */
fg_status fg_edges_name_defect(fg_context *ctx, fg_edge_work *work, unsigned *facts);

/* Finds the shape again, from the undisturbed part of the segments. edges_shape.c */
fg_status fg_edges_repeat_shape(fg_context *ctx, fg_edge_work *work);

/* Step 3: `rounds` of Gauss-Newton on all stations. edges_solve.c */
fg_status fg_edges_solve(fg_context *ctx, fg_edge_work *work, int rounds);

/* Adds all pixels of a chunk to their stations where the power gamma describes the driver;
 * residuals beyond `limit` are left out. edges_plain.c */
void fg_edges_add_plain(const fg_edge_work *work, size_t chunk, float limit);

/* Adds all pixels of a chunk to their stations under work->driver; residuals beyond `limit` are
 * left out. edges_driven.c */
fg_status fg_edges_add_driven(fg_context *ctx, const fg_edge_work *work, size_t chunk, float limit);

#endif
