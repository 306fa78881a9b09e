/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds of disturbance of a strip: a cut through it, or an object on it or beside it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "vision/edge_work.h"

/* Distances from the edges, in blurs, of pixels that count as inside (or the middle third) and as
 * beside (and a pixel). */
#define INSIDE_BLURS 1.5
#define BESIDE_BLURS 2.0
/* Min share of background in each third of the width at a cut of one row, of its area. */
#define CUT_SHARE 0.6
/* Min share of the band that an object beside the strip covers, over a length of one strip's width.
 */
#define TOUCH_SHARE 0.3
enum { THIRDS = 3 };

/* Pixels of one station by their place. */
typedef struct tally {
  float blank[THIRDS]; /* number at the background's level, within the strip */
  float foreign[2];    /* number at the strip's level, beside it */
} tally;

typedef struct defect {
  const fg_edge_work *work;
  double *middle_px;
  tally *tallies;
  double half_px, inside_px, beside_px;
} defect;

static bool is_disturbed(const fg_edge_work *work, size_t i) {
  return work->stations[i].facts & FG_STATION_DISTURBED;
}

/* Interpolates the strip's middle between the good stations on either side of a disturbed run. */
static void find_middles(defect *t) {
  const fg_edge_work *work = t->work;
  size_t count = work->reference->count, good = count;
  double sum = 0, n = 0;
  for (size_t i = 0; i < count; i++) {
    const fg_edge_station *s = &work->stations[i];
    if (!(s->weight > 0)) continue;
    t->middle_px[i] = 0.5 * (s->edge_px[0] + s->edge_px[1]);
    for (size_t k = good == count ? 0 : good + 1; k < i; k++) {
      double from = good == count ? t->middle_px[i] : t->middle_px[good];
      double share = good == count ? 0 : (double)(k - good) / (double)(i - good);
      t->middle_px[k] = from + share * (t->middle_px[i] - from);
    }
    sum += s->edge_px[1] - s->edge_px[0];
    n++;
    good = i;
  }
  for (size_t k = good + 1; good < count && k < count; k++)
    t->middle_px[k] = t->middle_px[good];
  double blur = fmax(work->blur_px[0], work->blur_px[1]);
  t->half_px = n > 0 ? 0.5 * sum / n : 0.5 * work->width_px;
  t->inside_px = fmax(t->half_px - INSIDE_BLURS * blur, t->half_px / 3);
  t->beside_px = t->half_px + BESIDE_BLURS * blur + 1;
}

/* 0 at the strip's level, 1 at the background's. */
static double depth_of(const fg_edge_work *work, const fg_edge_station *s, int side, float value) {
  float strip, background, rate;
  fg_edge_tone(work->tables, s->plateau, &strip, &rate);
  fg_edge_tone(work->tables, s->plateau + s->step[side], &background, &rate);
  return (value - strip) / (background - strip);
}

static void tally_station(defect *t, const fg_pixel_band *band, size_t station) {
  const fg_edge_work *work = t->work;
  size_t k = station - band->first;
  for (size_t i = band->begin[k]; i < band->begin[k + 1]; i++) {
    double across = band->across_px[i] - t->middle_px[station];
    bool blank = depth_of(work, &work->stations[station], across > 0, band->value[i]) > 0.5;
    if (fabs(across) < t->inside_px && blank)
      t->tallies[station].blank[(int)(THIRDS * (0.5 + 0.4999 * across / t->inside_px))]++;
    else if (fabs(across) > t->beside_px && !blank)
      t->tallies[station].foreign[across > 0]++;
  }
}

static void tally_pixels(defect *t) {
  const fg_pixel_band *bands = t->work->bands;
  for (size_t i = 0; i < t->work->reference->count; i++)
    if (is_disturbed(t->work, i)) tally_station(t, &bands[i / FG_CHUNK_STATIONS], i);
}

/* Facts of one run of disturbed stations. */
static unsigned name_run(const defect *t, size_t first, size_t last) {
  const fg_edge_work *work = t->work;
  double blank[THIRDS] = {0}, foreign[2] = {0};
  for (size_t i = first; i <= last; i++) {
    for (int k = 0; k < THIRDS; k++)
      blank[k] += t->tallies[i].blank[k];
    for (int k = 0; k < 2; k++)
      foreign[k] += t->tallies[i].foreign[k];
  }
  double row = CUT_SHARE * 2 * t->inside_px / THIRDS;
  double band = work->width_px / 2 + work->reach_px - t->beside_px;
  double touch = TOUCH_SHARE * 2 * t->half_px * band;
  bool cut = blank[0] >= row && blank[1] >= row && blank[2] >= row;
  bool touched = foreign[0] > touch || foreign[1] > touch;
  return (cut ? FG_STATION_CUT : 0) | (touched ? FG_STATION_TOUCHED : 0);
}

/* Names the runs within the strip's ends: beyond them there is background. */
static void name_runs(const defect *t, unsigned *facts) {
  const fg_edge_work *work = t->work;
  size_t count = work->reference->count;
  for (size_t first = 0; first < count; first++) {
    size_t last = first;
    if (!is_disturbed(work, first)) continue;
    while (last + 1 < count && is_disturbed(work, last + 1))
      last++;
    unsigned what = first > 0 && last + 1 < count ? name_run(t, first, last) : 0;
    /* Dust of the strip's own brightness is no other part. */
    if (!(*facts & FG_STRIP_TOUCHES_OTHER)) what &= ~(unsigned)FG_STATION_TOUCHED;
    if (what & FG_STATION_CUT) *facts |= FG_STRIP_GAP;
    for (size_t i = first; i <= last; i++)
      work->stations[i].facts |= what;
    first = last;
  }
}

fg_status fg_edges_name_defect(fg_context *ctx, fg_edge_work *work, unsigned *facts) {
  defect t = {.work = work};
  size_t count = work->reference->count;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *t.middle_px, (void **)&t.middle_px));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *t.tallies, (void **)&t.tallies));
  find_middles(&t);
  tally_pixels(&t);
  name_runs(&t, facts);
exit:
  free(t.middle_px);
  free(t.tallies);
  return status;
}
