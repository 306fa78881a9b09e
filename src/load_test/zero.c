/* What the load cell says where no foil pulls. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Places between the ends that up and down strokes share, less a share of the travel at each end;
 * windows as shares of it, the narrowest that holds samples. */
enum { PLACES = 49 };
static const double end_left_out = 0.05, window_share = 1.0 / 16, window_share_max = 0.25;

/* Where the force rises nowhere by less than this share of its steepest, there is no gap to see:
 * the share that a foil's stiffness may well vary by on its own. */
static const double flat_share = 0.5;

static fg_status merge_sense(fg_context *ctx, const fg_load_strokes *strokes, int sense,
                             fg_load_stroke *merged) {
  const fg_load_stroke **chosen;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, strokes->count, sizeof *chosen, (void **)&chosen));
  for (size_t i = 0; i < strokes->count; i++)
    if (strokes->stroke[i].sense == sense) chosen[count++] = &strokes->stroke[i];
  fg_status status = fg_load_strokes_merge(ctx, chosen, count, merged);
  free(chosen);
  return status;
}

static bool fit_at(const fg_load_stroke *stroke, double x, double span, fg_local_fit *fit) {
  for (double share = window_share; share <= window_share_max; share *= 2)
    if (fg_local_fit_at(stroke, x, share * span, fit)) return true;
  return false;
}

/* Where the mean of both rises least. */
static fg_load_zero find_flattest(const fg_load_stroke *up, const fg_load_stroke *down) {
  fg_load_zero zero = {NAN, NAN};
  double low = fmax(up->x[0], down->x[0]);
  double high = fmin(up->x[up->count - 1], down->x[down->count - 1]);
  double least = INFINITY, most = 0;
  for (size_t k = 0; k < PLACES && high > low; k++) {
    double share = end_left_out + (1 - 2 * end_left_out) * (double)k / (PLACES - 1);
    double x = low + share * (high - low);
    fg_local_fit a, b;
    if (!fit_at(up, x, high - low, &a) || !fit_at(down, x, high - low, &b)) continue;
    double slope = fabs(a.slope + b.slope) / 2;
    most = fmax(most, slope);
    if (slope >= least) continue;
    least = slope;
    zero = (fg_load_zero){(a.value + b.value) / 2, (a.value - b.value) / 2};
  }
  return least < flat_share * most ? zero : (fg_load_zero){NAN, NAN};
}

fg_status fg_load_find_zero(fg_context *ctx, const fg_load_strokes *strokes, fg_load_zero *zero) {
  fg_load_stroke up = {0}, down = {0};
  fg_status status = FG_OK;
  *zero = (fg_load_zero){NAN, NAN};
  FG_TRY_EXIT(merge_sense(ctx, strokes, 1, &up));
  FG_TRY_EXIT(merge_sense(ctx, strokes, -1, &down));
  if (up.count && down.count) *zero = find_flattest(&up, &down);
exit:
  fg_load_stroke_free(&up);
  fg_load_stroke_free(&down);
  return status;
}
