/* The state of a picture around one round or straight edge. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "vision/picture.h"
#include "vision/picture_profile.h"

enum { PIXEL_STEP = 5 };
#define OUTER_SHARE 0.25 /* of the band's reach: the levels' stretches at its ends */

/* A straight edge has one bearing, which is of no matter here. */
static double bearing_of(const fg_disc_work *work, size_t sector) {
  return work->open ? 0 : ((double)sector + 0.5) * 2 * M_PI / (double)work->ring.sector_count;
}

static size_t take_sectors(const fg_disc_work *work, fg_edge_profile *profiles) {
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
    n += fg_edge_profile_take(&source, &profiles[n]);
  }
  return n;
}

static void inspect_levels(const fg_disc_work *work, const fg_disc_edge *edge,
                           fg_picture_state *state) {
  fg_value_counts counts;
  double levels[2];
  fg_value_counts_clear(&counts);
  for (size_t i = 0; i < work->ring.count; i += PIXEL_STEP)
    fg_value_counts_add(&counts, work->ring.pixels[i].value);
  for (int side = 0; side < 2; side++)
    levels[side] = 255 * pow(fmax(side ? edge->outside : edge->inside, 0) / 255, 1 / edge->gamma);
  fg_picture_inspect_levels(&counts, levels, state);
  if (work->white[0] || work->white[1]) state->findings |= FG_PICTURE_CLIPPED;
}

fg_status fg_picture_of_ring(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state) {
  fg_edge_profile *profiles;
  state->noise = edge->noise;
  inspect_levels(work, edge, state);
  if (!work->open) FG_TRY(fg_picture_inspect_ring_rows(ctx, work, edge, state));
  FG_TRY(fg_memory_allocate(ctx, work->ring.sector_count, sizeof *profiles, (void **)&profiles));
  size_t count = take_sectors(work, profiles);
  fg_picture_inspect_cut(profiles, count, edge->blur_px, state);
  fg_status status = fg_picture_inspect_profiles(ctx, profiles, count, state);
  free(profiles);
  return status;
}
