/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of a picture: the unknown state, and the worse of two. */
#include "foilgauge/picture.h"

#include <math.h>

fg_picture_state fg_picture_unknown(void) {
  return (fg_picture_state){
      .gray_levels = NAN,
      .missing_levels = NAN,
      .clipped_low = NAN,
      .clipped_high = NAN,
      .undershoot = NAN,
      .overshoot = NAN,
      .block_noise = NAN,
      .blur_px = {NAN, NAN},
      .blur_direction_deg = NAN,
      .noise = NAN,
      .noise_correlation = {NAN, NAN},
      .shadow = NAN,
      .shadow_direction_deg = NAN,
      .row_jumps = NAN,
      .row_jump_px = NAN,
      .shading = NAN,
      .gamma = NAN,
      .u_gamma = NAN,
      .tone_s = NAN,
      .sharpen_amount = NAN,
      .sharpen_radius_px = NAN,
      .level = NAN,
      .u_level = NAN,
      .u_cut = NAN,
      .seen_blur = NAN,
  };
}

/* Keeps the larger; fmax and fmin prefer the number to NaN. */
static void keep_maximum(double *value, double other) {
  *value = fmax(*value, other);
}

/* Keeps the larger magnitude; returns 1 when it was the other's. */
static int keep_larger(double *value, double other) {
  if (!(fabs(other) > fabs(*value)) && !isnan(*value)) return 0;
  *value = other;
  return 1;
}

static void merge_blur(fg_picture_state *state, const fg_picture_state *other) {
  double ratio = state->blur_px[0] / state->blur_px[1];
  if (!(other->blur_px[0] / other->blur_px[1] > ratio) && !isnan(ratio)) return;
  state->blur_px[0] = other->blur_px[0];
  state->blur_px[1] = other->blur_px[1];
  state->blur_direction_deg = other->blur_direction_deg;
}

static void merge_tone(fg_picture_state *state, const fg_picture_state *other) {
  if (keep_larger(&state->u_level, other->u_level)) {
    state->level = other->level;
    state->level_known = other->level_known;
    state->gamma = other->gamma;
    state->u_gamma = other->u_gamma;
  }
  keep_larger(&state->tone_s, other->tone_s);
  if (keep_larger(&state->sharpen_amount, other->sharpen_amount))
    state->sharpen_radius_px = other->sharpen_radius_px;
}

void fg_picture_merge(fg_picture_state *state, const fg_picture_state *other) {
  state->gray_levels = fmin(state->gray_levels, other->gray_levels);
  keep_maximum(&state->missing_levels, other->missing_levels);
  keep_maximum(&state->clipped_low, other->clipped_low);
  keep_maximum(&state->clipped_high, other->clipped_high);
  keep_maximum(&state->undershoot, other->undershoot);
  keep_maximum(&state->overshoot, other->overshoot);
  keep_maximum(&state->block_noise, other->block_noise);
  if (!state->block_quality ||
      (other->block_quality && other->block_quality < state->block_quality))
    state->block_quality = other->block_quality;
  keep_maximum(&state->noise, other->noise);
  keep_maximum(&state->u_cut, other->u_cut);
  state->seen_blur = fmin(state->seen_blur, other->seen_blur);
  keep_maximum(&state->noise_correlation[0], other->noise_correlation[0]);
  keep_maximum(&state->noise_correlation[1], other->noise_correlation[1]);
  keep_maximum(&state->row_jumps, other->row_jumps);
  keep_maximum(&state->shading, other->shading);
  keep_larger(&state->row_jump_px, other->row_jump_px);
  if (keep_larger(&state->shadow, other->shadow))
    state->shadow_direction_deg = other->shadow_direction_deg;
  for (int i = 0; i < FG_PICTURE_BEARINGS; i++)
    keep_larger(&state->shadow_at[i], other->shadow_at[i]);
  merge_blur(state, other);
  merge_tone(state, other);
  state->findings |= other->findings;
}
