/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assignment of the stated gauges to the objects of a scan. */
#include "measure/gauges.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"

/* Max ratio of widths for a strip that may be a leaf, and a round feature that may be a pin or a
 * ring. A tone curve widens a leaf of ten pixels by a fifth, a disc of a hundred by less than a
 * twentieth. */
#define LEAF_FACTOR 1.25
#define DISC_FACTOR 1.05
/* Min length of a traced leaf, in widths (vision/trace.c). */
#define LEAF_WIDTHS 12.0
/* Min size, as a share of the smallest disc's stated diameter. */
#define DISC_SHARE 0.7

fg_status fg_gauge_sightings_add(fg_context *ctx, fg_gauge_sightings *sightings,
                                 const fg_gauge_sighting *one) {
  FG_TRY(fg_memory_reserve(ctx, sightings->count + 1, sizeof *sightings->list, &sightings->capacity,
                           (void **)&sightings->list));
  sightings->list[sightings->count++] = *one;
  return FG_OK;
}

double fg_gauge_min_px(const fg_measurement *m) {
  double min = INFINITY;
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    const fg_gauge *gauge = &m->design.gauges[i];
    min = fmin(min, gauge->width_mm * (gauge->kind == FG_GAUGE_LEAF ? LEAF_WIDTHS : DISC_SHARE));
  }
  return min * sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
}

fg_status fg_gauge_find_discs(fg_context *ctx, const fg_measurement *m,
                              fg_gauge_sightings *sightings) {
  for (size_t d = 0; d < m->disc_count; d++) {
    const fg_disc *disc = &m->discs[d];
    double r = disc->radius_mm, level = disc->level_u_mm;
    fg_gauge_sighting one = {
        .kind = disc->hole ? FG_GAUGE_HOLE : FG_GAUGE_PIN,
        .width_mm = disc->plain_mm,
        .u_mm = 2 * sqrt(fmax(disc->u_radius_mm * disc->u_radius_mm - level * level, 0)),
        .blur_mm = disc->plain_blur_um / 1000,
        .contrast = disc->contrast,
        .bright = disc->bright,
        .place_mm = {disc->centre_mm.x - r, disc->centre_mm.y - r, 2 * r, 2 * r},
        .spoiled = disc->flags & FG_BUMP_POOR_FIT ? "it is not round" : NULL};
    FG_TRY(fg_gauge_sightings_add(ctx, sightings, &one));
  }
  return FG_OK;
}

static bool is_of_kind(fg_gauge_kind stated, fg_gauge_kind seen) {
  return stated == seen || (stated == FG_GAUGE_RING && seen == FG_GAUGE_HOLE);
}

/* Distance of a sighting from a gauge: the logarithm of their widths' ratio, INFINITY for another
 * kind. */
static double width_distance(const fg_gauge *gauge, const fg_gauge_sighting *seen) {
  return is_of_kind(gauge->kind, seen->kind) ? fabs(log(seen->width_mm / gauge->width_mm))
                                             : INFINITY;
}

static void fill_reading(const fg_gauge_sighting *seen, fg_gauge_reading *reading) {
  *reading = (fg_gauge_reading){.found = true,
                                .used = !seen->spoiled,
                                .measured_mm = seen->width_mm,
                                .u_measured_mm = seen->u_mm,
                                .level = NAN,
                                .u_level = NAN,
                                .blur_mm = seen->blur_mm,
                                .contrast = seen->contrast,
                                .bright = seen->bright};
  memcpy(reading->place_mm, seen->place_mm, sizeof reading->place_mm);
  if (seen->spoiled) fg_text_clip(reading->note, sizeof reading->note, "%s", seen->spoiled);
}

/* Sighting of each gauge, by gauge; none for a gauge that was not found. */
typedef struct matches {
  size_t of[FG_GAUGES_MAX];
} matches;

static bool is_assigned(const fg_measurement *m, const matches *taken, size_t sighting) {
  for (size_t k = 0; k < m->design.gauge_count; k++)
    if (m->gauges[k].found && taken->of[k] == sighting) return true;
  return false;
}

/* Names the object of its kind that is nearest in width. */
static void note_missing(const fg_gauge_sightings *sightings, const matches *taken, size_t missing,
                         fg_measurement *m) {
  const fg_gauge *gauge = &m->design.gauges[missing];
  fg_gauge_reading *reading = &m->gauges[missing];
  const fg_gauge_sighting *nearest = NULL;
  for (size_t i = 0; i < sightings->count; i++)
    if (isfinite(width_distance(gauge, &sightings->list[i])) &&
        (!nearest || width_distance(gauge, &sightings->list[i]) < width_distance(gauge, nearest)))
      nearest = &sightings->list[i];
  const char *what = gauge->kind == FG_GAUGE_LEAF  ? "straight strip"
                     : gauge->kind == FG_GAUGE_PIN ? "disc"
                                                   : "round hole";
  if (!nearest)
    fg_text_clip(reading->note, sizeof reading->note, "no %s lies in the scan", what);
  else
    fg_text_clip(reading->note, sizeof reading->note,
                 "the nearest %s reads %.4f mm, at x %.1f, y %.1f mm%s", what, nearest->width_mm,
                 nearest->place_mm[0], nearest->place_mm[1],
                 is_assigned(m, taken, (size_t)(nearest - sightings->list))
                     ? ", and is taken for another stated gauge"
                     : "");
}

void fg_gauges_match(const fg_gauge_sightings *sightings, fg_measurement *m) {
  matches taken;
  size_t count = m->design.gauge_count;
  for (size_t round = 0; round < count; round++) {
    size_t gauge = count, sighting = 0;
    double best = INFINITY;
    for (size_t g = 0; g < count; g++) {
      double limit = log(m->design.gauges[g].kind == FG_GAUGE_LEAF ? LEAF_FACTOR : DISC_FACTOR);
      for (size_t i = 0; i < sightings->count && !m->gauges[g].found; i++) {
        double far = width_distance(&m->design.gauges[g], &sightings->list[i]);
        if (is_assigned(m, &taken, i) || far > limit || far >= best) continue;
        best = far;
        gauge = g;
        sighting = i;
      }
    }
    if (gauge == count) break;
    taken.of[gauge] = sighting;
    fill_reading(&sightings->list[sighting], &m->gauges[gauge]);
  }
  for (size_t g = 0; g < count; g++)
    if (!m->gauges[g].found) note_missing(sightings, &taken, g, m);
}
