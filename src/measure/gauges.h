/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges on the glass, found among the objects of a scan. */
#ifndef FG_MEASURE_GAUGES_H
#define FG_MEASURE_GAUGES_H

#include "foilgauge/foil.h"
#include "vision/segment.h"
#include "vision/trace.h"

/* An object of a scan that may be a gauge. */
typedef struct fg_gauge_sighting {
  fg_gauge_kind kind; /* a leaf, a pin, or a hole, which includes a ring's bore */
  double width_mm, u_mm;
  double length_mm; /* of a leaf */
  double blur_mm, contrast;
  bool bright;
  double place_mm[4];
  const char *spoiled; /* reason against its use; NULL: none */
} fg_gauge_sighting;

typedef struct fg_gauge_sightings {
  fg_gauge_sighting *list; /* owned */
  size_t count, capacity;
} fg_gauge_sightings;

fg_status fg_gauge_sightings_add(fg_context *ctx, fg_gauge_sightings *sightings,
                                 const fg_gauge_sighting *one);

/* Returns the diagonal of the smallest object that may be a gauge of the design, px; INFINITY: none
 * is sought. */
double fg_gauge_min_px(const fg_measurement *m);

/* Place of an object: the island's tiles, and their corner in the scan. */
typedef struct fg_gauge_object {
  const fg_measurement *measurement; /* for design, dpi, jpeg_quality */
  const fg_tiles *tiles;
  const fg_segmentation *segmentation;
  const fg_object *object;
  const int64_t *origin_px;
} fg_gauge_object;

/* Tests an object for a round gauge: a pin, or holes in the object. *taken: it is a gauge, and no
 * foil. */
fg_status fg_gauge_find_round(fg_context *ctx, const fg_gauge_object *object,
                              fg_gauge_sightings *sightings, bool *taken);

/* Tests a traced strip for a leaf. *taken: it is straight, and so no foil. */
fg_status fg_gauge_test_leaf(fg_context *ctx, const fg_gauge_object *object, const fg_trace *trace,
                             unsigned threads, fg_gauge_sightings *sightings, bool *taken);

/* Tests an object that has no trace at the width of a foil for one of a leaf's width. */
fg_status fg_gauge_trace_leaf(fg_context *ctx, const fg_gauge_object *object, unsigned threads,
                              fg_gauge_sightings *sightings, bool *taken);

/* Adds the round features of a scan of discs as sightings. */
fg_status fg_gauge_find_discs(fg_context *ctx, const fg_measurement *m,
                              fg_gauge_sightings *sightings);

/* Fills m->gauges: each stated gauge gets the sighting of nearest width, and no sighting serves
 * twice. */
void fg_gauges_match(const fg_gauge_sightings *sightings, fg_measurement *m);

#endif
