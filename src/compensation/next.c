/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The next die: the law of the springback turned round, cut to the shop's step, within limits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compensation/expected.h"
#include "compensation/inputs.h"
#include "compensation/setting.h"
#include "compensation/springback.h"
#include "core/memory.h"

static double degrees_of(double radians) {
  return radians * 180 / M_PI;
}

/* The target's size of a quantity: mm, degrees. */
static double target_size(const fg_design *target, fg_formed formed) {
  switch (formed) {
  case FG_FORMED_RADIUS:
    return target->bumps.radius_mm;
  case FG_FORMED_ARC_LENGTH:
    return target->bumps.radius_mm * target->bumps.angle_deg / 180 * M_PI;
  case FG_FORMED_PITCH:
    return target->bumps.pitch_deg;
  default:
    return target->overall_radius_mm;
  }
}

fg_status fg_formed_laws_find(fg_context *ctx, size_t bumps, fg_next_die *next) {
  int numbers[FG_COMPENSATION_BUMPS];
  void *block;
  for (size_t i = 0; i < bumps; i++)
    numbers[i] = (int)i + 1;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *next->laws, &block));
  next->laws = block;
  for (int q = 0; q < FG_FORMED; q++) {
    if (q != FG_FORMED_OVERALL && !bumps) continue;
    const fg_springback_data data = {.formed = (fg_formed)q,
                                     .sets = next->law->set,
                                     .set_count = next->law->sets,
                                     .bump_numbers = numbers,
                                     .bump_count = bumps,
                                     .target = target_size(&next->target, (fg_formed)q)};
    FG_TRY(fg_springback_find(ctx, &data, &next->laws->of[q]));
    fg_springback_describe(&next->laws->of[q], &next->law->of[q]);
  }
  return FG_OK;
}

void fg_formed_laws_free(struct fg_formed_laws *laws) {
  for (int q = 0; laws && q < FG_FORMED; q++)
    fg_springback_fit_free(&laws->of[q]);
  free(laws);
}

static double round_to_step(double mm, double step_um) {
  return step_um > 0 ? round(mm * 1000 / step_um) * step_um / 1000 : mm;
}

/* u of the logarithm of a size that lands the mean on the target. */
static double u_of_size(const fg_springback_fit *fit, size_t place, double log_die) {
  return fg_springback_u(fit, place, log_die, false) / fabs(1 + fit->state_mean[FG_STATE_EXPONENT]);
}

static void find_bump(const fg_next_die *next, size_t i, fg_die_bump_dimensions *bump) {
  const fg_springback_fit *radius = &next->laws->of[FG_FORMED_RADIUS],
                          *arc = &next->laws->of[FG_FORMED_ARC_LENGTH];
  double log_radius = fg_springback_invert(radius, i), log_arc = fg_springback_invert(arc, i);
  double u_radius = u_of_size(radius, i, log_radius), u_arc = u_of_size(arc, i, log_arc);
  bump->number = (int)i + 1;
  bump->radius_mm = round_to_step(exp(log_radius), next->step_um);
  bump->u_radius_mm = bump->radius_mm * u_radius;
  bump->bump_angle_deg = degrees_of(exp(log_arc) / bump->radius_mm);
  bump->u_bump_angle_deg = bump->bump_angle_deg * hypot(u_arc, u_radius);
}

/* Makes all bumps alike: the mean of their radii and of their arc lengths. */
static void make_common(fg_next_die *next) {
  fg_die_dimensions *die = &next->die;
  double radius = 0, angle = 0, count = (double)die->bumps;
  for (size_t i = 0; i < die->bumps; i++) {
    radius += die->bump[i].radius_mm / count;
    angle += die->bump[i].radius_mm * die->bump[i].bump_angle_deg / count;
  }
  radius = round_to_step(radius, next->step_um);
  for (size_t i = 0; i < die->bumps; i++) {
    die->bump[i].radius_mm = radius;
    die->bump[i].bump_angle_deg = angle / radius;
  }
}

static void find_whole(fg_next_die *next) {
  fg_die_dimensions *die = &next->die;
  const fg_springback_fit *overall = &next->laws->of[FG_FORMED_OVERALL],
                          *pitch = &next->laws->of[FG_FORMED_PITCH];
  double log_overall = fg_springback_invert(overall, 0);
  die->overall_radius_mm = round_to_step(exp(log_overall), next->step_um);
  die->u_overall_radius_mm = die->overall_radius_mm * u_of_size(overall, 0, log_overall);
  if (!die->bumps) return;
  double log_pitch = fg_springback_invert(pitch, 0);
  die->pitch_deg = exp(log_pitch);
  die->u_pitch_deg = die->pitch_deg * u_of_size(pitch, 0, log_pitch);
  die->fillet_radius_mm = next->target.bumps.fillet_radius_mm;
}

/* A step far beyond what lots have shown would rest on the law's form alone. */
static fg_status check_step(fg_context *ctx, const fg_next_die *next, const char *words,
                            double present, double size) {
  double step = 100 * (size / present - 1);
  if (fabs(step) <= next->max_move_pct) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the target asks for %.4f mm, a step of %+.1f %% from the present die's %.4f "
                 "mm, beyond %g %%: cut a die between them and measure its lot, or allow the step "
                 "with --max-move-pct",
                 words, size, step, present, next->max_move_pct);
}

static fg_status check_limits(fg_context *ctx, const fg_next_die *next) {
  char words[40];
  FG_TRY(check_step(ctx, next, "overall radius", next->present.overall_radius_mm,
                    next->die.overall_radius_mm));
  for (size_t i = 0; i < next->die.bumps; i++) {
    const fg_die_bump_dimensions *bump = &next->die.bump[i];
    snprintf(words, sizeof words, "radius of bump %d", bump->number);
    FG_TRY(check_step(ctx, next, words, next->present.bump[i].radius_mm, bump->radius_mm));
    if (bump->radius_mm < next->min_radius_mm)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: the target asks for %.4f mm, below the smallest radius that can be cut, "
                     "%g mm: a warmer or longer heat treatment springs back less",
                     words, bump->radius_mm, next->min_radius_mm);
  }
  return FG_OK;
}

static const fg_formed_place *find_formed_place(const fg_formed_data *data, int number) {
  for (size_t i = 0; i < data->places; i++)
    if (data->place[i].number == number) return &data->place[i];
  return NULL;
}

/* Share of the bumps' own deviations from their mean in the last set that the die takes: few foils
 * that scatter tell little of one bump. */
static double find_step_share(const fg_next_die *next) {
  const fg_formed_data *data = &next->law->set[next->law->sets - 1].of[FG_FORMED_RADIUS];
  double asked_mean = 0, taken_mean = 0, count = 0, product = 0, square = 0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < next->die.bumps; i++) {
      const fg_formed_place *place = find_formed_place(data, (int)i + 1);
      if (!place) continue;
      double asked = -place->log_ratio, taken = log(next->die.bump[i].radius_mm);
      if (pass == 0) {
        count++;
        asked_mean += (asked - asked_mean) / count;
        taken_mean += (taken - taken_mean) / count;
      } else {
        product += (asked - asked_mean) * (taken - taken_mean);
        square += (asked - asked_mean) * (asked - asked_mean);
      }
    }
  return square > 0 ? product / square : NAN;
}

static void note_step(fg_next_die *next) {
  const fg_formed_set *last = &next->law->set[next->law->sets - 1];
  next->step_share = next->common ? NAN : find_step_share(next);
  if (next->step_share < 0.9)
    fg_next_die_note(next,
                     "The die follows the bumps' own deviations to %.0f %%: more is not proven by "
                     "the scatter of %zu foil%s of %s",
                     100 * fmax(0, next->step_share), last->foils, last->foils == 1 ? "" : "s",
                     last->lot);
  if (next->law->sets == 1)
    fg_next_die_note(next,
                     "One die tells neither how springback depends on the die's radius nor "
                     "how lots differ: both are in U by what is usual, and the next lot tells");
  for (size_t i = 0; i < next->die.bumps; i++)
    if (!next->laws->of[FG_FORMED_RADIUS].seen[i])
      fg_next_die_note(next,
                       "Bump %zu was in no lot: its radius is the law's for all bumps, its U "
                       "is larger",
                       i + 1);
}

static fg_status solve_die(fg_context *ctx, const fg_compensation_request *request, size_t bumps,
                           fg_next_die *next) {
  next->step_um = request->step_um;
  next->min_radius_mm = request->min_radius_mm;
  next->max_move_pct =
      request->max_move_pct > 0 ? request->max_move_pct : FG_COMPENSATION_MAX_MOVE_PCT;
  next->common = request->common;
  FG_TRY(fg_formed_laws_find(ctx, bumps, next));
  next->die.bumps = bumps;
  for (size_t i = 0; i < bumps; i++)
    find_bump(next, i, &next->die.bump[i]);
  if (next->common) make_common(next);
  find_whole(next);
  FG_TRY(check_limits(ctx, next));
  FG_TRY(fg_die_dimensions_derive(ctx, &next->target, &next->die));
  note_step(next);
  return FG_OK;
}

static fg_status keep_sets(fg_context *ctx, const fg_formed_sets *sets, fg_next_die *next) {
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *next->law, (void **)&next->law));
  next->law->sets = sets->count;
  memcpy(next->law->set, sets->set, sets->count * sizeof *sets->set);
  return FG_OK;
}

fg_status fg_next_die_find(fg_context *ctx, const fg_compensation_request *request,
                           fg_next_die *next) {
  fg_compensation_inputs inputs = {.bumps = 0};
  fg_status status = FG_OK;
  *next = (fg_next_die){.law = NULL};
  FG_TRY_EXIT(fg_compensation_inputs_read(ctx, request, next, &inputs));
  FG_TRY_EXIT(keep_sets(ctx, &inputs.sets, next));
  next->present = inputs.present;
  FG_TRY_EXIT(solve_die(ctx, request, inputs.bumps, next));
  next->expected.foils =
      request->foils ? request->foils : next->law->set[next->law->sets - 1].foils;
  FG_TRY_EXIT(fg_expected_lot_find(ctx, &inputs.sets, next));
  if (request->experiment.runs) FG_TRY_EXIT(fg_setting_trade_find(ctx, &request->experiment, next));
exit:
  fg_formed_sets_free(&inputs.sets);
  if (status != FG_OK) fg_next_die_free(next);
  return status;
}

void fg_next_die_free(fg_next_die *next) {
  free(next->law);
  fg_formed_laws_free(next->laws);
  next->law = NULL;
  next->laws = NULL;
}
