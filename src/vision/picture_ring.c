/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of a picture around one round or straight edge. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "vision/picture.h"
#include "vision/picture_profile.h"

enum { PIXEL_STEP = 5, TILES_MAX = 16 };
#define OUTER_SHARE 0.25 /* of the band's reach: the levels' stretches at its ends */

/* Bearing of a sector; a straight edge has a single one, which does not matter here. */
static double bearing_of(const fg_disc_work *work, size_t sector) {
  return work->open ? 0 : ((double)sector + 0.5) * 2 * M_PI / (double)work->ring.sector_count;
}

static size_t make_profiles(const fg_disc_work *work, fg_edge_profile *profiles) {
  const fg_ring *ring = &work->ring;
  double outer = OUTER_SHARE * ring->reach_px;
  size_t n = 0;
  for (size_t i = 0; i < ring->sector_count; i++) {
    const fg_step_fit *fit = &work->sectors[i];
    if (!fit->good) continue;
    const fg_profile_source source = {.bins = work->bins + i * work->bin_count,
                                      .count = work->bin_count,
                                      .way = 1,
                                      .middle_px = -ring->reach_px + outer / 2,
                                      .plateau_px = outer / 2,
                                      .reach_px = outer,
                                      .bearing = bearing_of(work, i),
                                      .blur_px = fit->values[FG_STEP_BLUR],
                                      .background = NAN};
    n += fg_edge_profile_make(&source, &profiles[n]);
  }
  return n;
}

static double count_at_gamma(double gamma, double light) {
  return 255 * pow(fmax(light, 0) / 255, 1 / gamma);
}

static void inspect_levels(const fg_disc_work *work, const fg_disc_edge *edge,
                           fg_picture_state *state) {
  fg_value_counts counts;
  double levels[2];
  fg_value_counts_clear(&counts);
  for (size_t i = 0; i < work->ring.count; i += PIXEL_STEP)
    fg_value_counts_add(&counts, work->ring.pixels[i].value);
  for (int side = 0; side < 2; side++)
    levels[side] = count_at_gamma(edge->gamma, side ? edge->outside : edge->inside);
  fg_picture_inspect_levels(&counts, levels, state);
  if (work->white[0] || work->white[1]) state->findings |= FG_PICTURE_CLIPPED;
}

static bool is_chosen(const fg_tile_choice *choice, const fg_tile *tile) {
  for (size_t i = 0; i < choice->count; i++)
    if (choice->tiles[i] == tile) return true;
  return false;
}

/* Chooses whole tiles that the edge crosses, evenly around it. */
static void choose_around(const fg_disc_work *work, fg_tile_choice *choice) {
  const fg_circle *c = &work->ring.circle;
  choice->count = 0;
  for (int k = 0; k < TILES_MAX; k++) {
    double angle = (k + 0.5) * 2 * M_PI / TILES_MAX;
    double x = (c->x + c->radius * cos(angle)) / work->shape->scale[0];
    double y = (c->y + c->radius * sin(angle)) / work->shape->scale[1];
    int32_t column = (int32_t)floor(x / FG_TILE_PX), row = (int32_t)floor(y / FG_TILE_PX);
    if (column < 0 || row < 0 || (int64_t)(column + 1) * FG_TILE_PX > work->tiles->width_px ||
        (int64_t)(row + 1) * FG_TILE_PX > work->tiles->height_px)
      continue;
    const fg_tile *tile = fg_tiles_at(work->tiles, column, row);
    if (tile && !is_chosen(choice, tile)) choice->tiles[choice->count++] = tile;
  }
}

static void inspect_blocks(const fg_disc_work *work, const fg_disc_edge *edge,
                           fg_picture_state *state) {
  fg_tile_choice choice;
  choose_around(work, &choice);
  double contrast =
      fabs(count_at_gamma(edge->gamma, edge->inside) - count_at_gamma(edge->gamma, edge->outside));
  fg_picture_inspect_blocks(&choice, work->tiles->bytes_per_pixel, contrast, state);
}

fg_status fg_picture_of_ring(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state) {
  fg_edge_profile *profiles;
  state->noise = edge->noise;
  inspect_levels(work, edge, state);
  if (!work->open) inspect_blocks(work, edge, state);
  if (!work->open) FG_TRY(fg_picture_inspect_ring_rows(ctx, work, edge, state));
  FG_TRY(fg_memory_allocate(ctx, work->ring.sector_count, sizeof *profiles, (void **)&profiles));
  size_t count = make_profiles(work, profiles);
  fg_picture_inspect_cut(profiles, count, edge->blur_px, state);
  fg_status status = fg_picture_inspect_profiles(ctx, profiles, count, state);
  free(profiles);
  return status;
}
