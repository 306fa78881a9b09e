/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of a picture around a strip. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/picture.h"
#include "vision/picture_profile.h"

enum { PIXEL_STEP = 5, TILES_MAX = 12 };
#define PLATEAU_SHARE 0.15 /* half of the stretch across the strip whose median is its level */
#define OUTER_PX      2.5
#define CLIPPED_NOISE 1.0

/* Makes the profiles of both edges of one segment; returns their number. */
static size_t make_profiles(const fg_edge_work *work, size_t i, fg_edge_profile *profiles) {
  const fg_segment_profile *s = &work->segments[i];
  size_t middle = i * FG_SEGMENT_STATIONS + FG_SEGMENT_STATIONS / 2, n = 0;
  if (middle >= work->reference->count) return 0;
  const fg_reference_station *r = &work->reference->stations[middle];
  for (int side = 0; side < 2; side++) {
    int way = side ? 1 : -1;
    const fg_profile_source source = {.bins = s->bins,
                                      .count = work->bin_count,
                                      .way = way,
                                      .plateau_px = PLATEAU_SHARE * work->width_px,
                                      .reach_px = OUTER_PX,
                                      .bearing = atan2(way * r->tx, -way * r->ty),
                                      .blur_px = s->fit.good ? s->fit.shape.blur_px[side] : NAN,
                                      .background = (double)fg_edges_background(work, r)};
    n += fg_edge_profile_make(&source, &profiles[n]);
  }
  return n;
}

static double median_level(const fg_edge_profile *profiles, size_t count, bool inside,
                           double *scratch) {
  for (size_t i = 0; i < count; i++)
    scratch[i] = inside ? profiles[i].inside : profiles[i].outside;
  return fg_select(scratch, count, count / 2);
}

static void count_values(const fg_edge_work *work, fg_value_counts *counts) {
  fg_value_counts_clear(counts);
  for (size_t c = 0; c < work->chunk_count; c++)
    for (size_t i = 0; i < work->bands[c].count; i += PIXEL_STEP)
      fg_value_counts_add(counts, work->bands[c].value[i]);
}

/* Returns true when a kept tile lies inside the scan and holds no part of an object. */
static bool is_flat(const fg_segmentation *seg, int32_t column, int32_t row) {
  const fg_tiles *tiles = seg->tiles;
  if ((int64_t)(column + 1) * FG_TILE_PX > tiles->width_px ||
      (int64_t)(row + 1) * FG_TILE_PX > tiles->height_px || !fg_tiles_at(tiles, column, row))
    return false;
  for (int32_t y = -1; y <= FG_BLOCKS_PER_TILE; y++)
    for (int32_t x = -1; x <= FG_BLOCKS_PER_TILE; x++)
      if (fg_segmentation_label(seg, column * FG_BLOCKS_PER_TILE + x, row * FG_BLOCKS_PER_TILE + y))
        return false;
  return true;
}

/* Chooses up to TILES_MAX of the flat tiles, spread over all. */
static void choose_flat(const fg_segmentation *seg, fg_tile_choice *choice) {
  size_t seen = 0, step = 1;
  choice->count = 0;
  for (int32_t row = 0; row < seg->tiles->rows; row++)
    for (int32_t column = 0; column < seg->tiles->columns; column++) {
      if (!is_flat(seg, column, row) || seen++ % step) continue;
      if (choice->count == TILES_MAX) {
        for (size_t i = 0; 2 * i < TILES_MAX; i++)
          choice->tiles[i] = choice->tiles[2 * i];
        choice->count = TILES_MAX / 2;
        step *= 2;
      }
      choice->tiles[choice->count++] = fg_tiles_at(seg->tiles, column, row);
    }
}

/* Chooses tiles that the strip crosses, evenly along it. */
static void choose_along(const fg_edge_work *work, fg_tile_choice *choice) {
  size_t count = work->reference->count;
  choice->count = 0;
  for (size_t k = 0; k < TILES_MAX; k++) {
    const fg_reference_station *r =
        &work->reference->stations[(2 * k + 1) * count / (2 * TILES_MAX)];
    int32_t column = (int32_t)(r->x / FG_TILE_PX), row = (int32_t)(r->y / FG_TILE_PX);
    if (r->x < 0 || r->y < 0 || (int64_t)(column + 1) * FG_TILE_PX > work->tiles->width_px ||
        (int64_t)(row + 1) * FG_TILE_PX > work->tiles->height_px)
      continue;
    const fg_tile *tile = fg_tiles_at(work->tiles, column, row);
    if (tile) choice->tiles[choice->count++] = tile;
  }
}

/* Range of the background over the strip, as a share of the contrast. */
static double find_shading(const fg_edge_work *work, double contrast) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < work->reference->count; i += FG_SEGMENT_STATIONS) {
    double at = (double)fg_edges_background(work, &work->reference->stations[i]);
    low = fmin(low, at);
    high = fmax(high, at);
  }
  return (high - low) / contrast;
}

/* Stations whose pixels make one band: a bump turns so little over them that a shadow of a few
 * bearings does not fade among others. */
enum { BAND_STATIONS = 16 };

/* Sums of the pixels of the bands beside the edges, left and right of every stretch. */
typedef struct band_sums {
  double *sums, *counts;
} band_sums;

/* Adds a station's pixels beside its edges. Most pixels lie on the material or in the blur of its
 * edges, nearer than `nearest`: they are passed over first. */
static void add_station_band(const fg_edge_work *work, const fg_pixel_band *band, size_t k,
                             float nearest, band_sums *b) {
  size_t station = band->first + k, at = 2 * (station / BAND_STATIONS);
  const fg_edge_station *s = &work->stations[station];
  if (!(s->weight > 0)) return;
  for (size_t i = band->begin[k]; i < band->begin[k + 1]; i++) {
    float left = s->edge_px[0] - band->across_px[i], right = band->across_px[i] - s->edge_px[1];
    int side = right > left;
    float out_px = side ? right : left;
    if (out_px < nearest) continue;
    double d = (double)out_px - fg_band_from(fmax(work->blur_px[side], (double)s->blur_px[side]));
    if (d < 0 || d > FG_BAND_PX) continue;
    b->sums[at + (size_t)side] += (double)band->value[i];
    b->counts[at + (size_t)side]++;
  }
}

static void add_bands(const fg_edge_work *work, band_sums *b) {
  float nearest = (float)fg_band_from(fmin(work->blur_px[0], work->blur_px[1]));
  for (size_t c = 0; c < work->chunk_count; c++)
    for (size_t k = 0; k < work->bands[c].stations; k++)
      add_station_band(work, &work->bands[c], k, nearest, b);
}

static fg_edge_band band_of(const fg_edge_work *work, const band_sums *b, size_t at,
                            double inside) {
  size_t station = at / 2 * BAND_STATIONS + BAND_STATIONS / 2;
  if (station >= work->reference->count) station = work->reference->count - 1;
  const fg_reference_station *r = &work->reference->stations[station];
  int way = at % 2 ? 1 : -1;
  double background = (double)fg_edges_background(work, r);
  return (fg_edge_band){
      .bearing = atan2(way * r->tx, -way * r->ty),
      .share = b->counts[at] > 0
                   ? (b->sums[at] / b->counts[at] - background) / (inside - background)
                   : NAN,
  };
}

static fg_status inspect_bands(fg_context *ctx, const fg_edge_work *work, double inside,
                               fg_picture_state *state) {
  size_t count = 2 * ((work->reference->count + BAND_STATIONS - 1) / BAND_STATIONS);
  fg_edge_band *bands = NULL;
  band_sums sums = {0};
  fg_picture_state fine = fg_picture_unknown();
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *bands, (void **)&bands));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * count, sizeof *sums.sums, (void **)&sums.sums));
  sums.counts = sums.sums + count;
  add_bands(work, &sums);
  for (size_t i = 0; i < count; i++)
    bands[i] = band_of(work, &sums, i, inside);
  fine.shading = state->shading;
  FG_TRY_EXIT(fg_picture_inspect_bands(ctx, bands, count, &fine));
  if (!(fine.findings & FG_PICTURE_SHADOW)) goto exit;
  state->findings |= FG_PICTURE_SHADOW;
  state->shadow = fine.shadow;
  state->shadow_direction_deg = fine.shadow_direction_deg;
  memcpy(state->shadow_at, fine.shadow_at, sizeof state->shadow_at);
exit:
  free(bands);
  free(sums.sums);
  return status;
}

/* Max shading; up to it the background between tiles follows the light. */
#define SHADING_SHARE 1.0

/* Returns true when values are clipped. A picture without noise piles up at both ends without
 * clipping: not one whose edges have noise, unless its levels are far apart. */
static bool is_clipped(const fg_edge_work *work, const fg_picture_state *state) {
  if (work->clipped) return true;
  return state->clipped_low > 0 && state->clipped_high > 0 && work->noise > CLIPPED_NOISE &&
         !(state->findings & FG_PICTURE_FEW_LEVELS);
}

static fg_status inspect_strip(fg_context *ctx, const fg_edge_work *work, fg_edge_profile *profiles,
                               double *scratch, fg_picture_state *state) {
  size_t count = 0;
  for (size_t i = 0; i < work->segment_count; i++)
    count += make_profiles(work, i, profiles + count);
  if (!count) return FG_OK;
  const double levels[2] = {median_level(profiles, count, true, scratch),
                            median_level(profiles, count, false, scratch)};
  double contrast = fabs(levels[0] - levels[1]);
  fg_tile_choice choice;
  fg_value_counts counts;
  choose_flat(work->segmentation, &choice);
  fg_picture_inspect_noise(&choice, work->tiles->bytes_per_pixel, state);
  choose_along(work, &choice);
  fg_picture_inspect_blocks(&choice, work->tiles->bytes_per_pixel, contrast, state);
  if (state->findings & FG_PICTURE_BLOCK_NOISE) /* the blocks make neighbours alike */
    state->findings &= ~(unsigned)FG_PICTURE_CORRELATED_NOISE;
  count_values(work, &counts);
  fg_picture_inspect_levels(&counts, levels, state);
  if (is_clipped(work, state)) state->findings |= FG_PICTURE_CLIPPED;
  state->shading = find_shading(work, contrast);
  if (state->shading > SHADING_SHARE) state->findings |= FG_PICTURE_SHADING;
  fg_picture_inspect_cut(profiles, count, 0.5 * (work->blur_px[0] + work->blur_px[1]), state);
  FG_TRY(fg_picture_inspect_profiles(ctx, profiles, count, state));
  FG_TRY(inspect_bands(ctx, work, levels[0], state));
  return fg_picture_inspect_rows(ctx, work, state);
}

fg_status fg_picture_of_strip(fg_context *ctx, const fg_edge_work *work, fg_picture_state *state) {
  fg_edge_profile *profiles = NULL;
  double *scratch = NULL;
  fg_status status = FG_OK;
  size_t max = 2 * work->segment_count;
  if (!max) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, max, sizeof *profiles, (void **)&profiles));
  FG_TRY_EXIT(fg_memory_allocate(ctx, max, sizeof *scratch, (void **)&scratch));
  FG_TRY_EXIT(inspect_strip(ctx, work, profiles, scratch, state));
exit:
  free(profiles);
  free(scratch);
  return status;
}
