/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/draws.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/splitmix.h"

/* Fewer foils do not show their distribution. */
enum { DEVIATIONS_MIN = 5 };

static double place_mean(const fg_formed_data *data, int number) {
  for (size_t i = 0; i < data->places; i++)
    if (data->place[i].number == number) return data->place[i].log_ratio;
  return NAN;
}

/* A deviation from the mean of n foils, of which it is one, is too small by (n - 1) / n. */
static void fill_deviation(const fg_formed_set *set, const fg_formed_foil *foil, size_t bumps,
                           fg_formed_foil *deviation) {
  double wider = sqrt((double)set->foils / ((double)set->foils - 1));
  for (int q = 0; q < 2; q++)
    for (size_t i = 0; i < bumps; i++)
      deviation->log_ratio[q][i] =
          wider * (foil->log_ratio[q][i] - place_mean(&set->of[q], (int)i + 1));
  deviation->overall = wider * (foil->overall - place_mean(&set->of[FG_FORMED_OVERALL], 0));
  deviation->pitch = wider * (foil->pitch - place_mean(&set->of[FG_FORMED_PITCH], 0));
}

fg_status fg_drawer_begin(fg_context *ctx, const struct fg_formed_laws *laws,
                          const fg_die_dimensions *die, const fg_formed_sets *sets,
                          fg_drawer *drawer) {
  size_t foils = sets ? sets->foils : 0;
  *drawer = (fg_drawer){.laws = laws, .die = die, .state = 1};
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *drawer->deviation, (void **)&drawer->deviation));
  for (size_t i = 0; i < foils; i++) {
    const fg_formed_set *set = &sets->set[sets->foil_set[i]];
    if (set->foils > 1)
      fill_deviation(set, &sets->foil[i], die->bumps, &drawer->deviation[drawer->deviations++]);
  }
  if (drawer->deviations < DEVIATIONS_MIN) drawer->deviations = 0;
  return FG_OK;
}

void fg_drawer_end(fg_drawer *drawer) {
  free(drawer->deviation);
  drawer->deviation = NULL;
}

static const fg_springback_point *draw_point(fg_drawer *drawer, const fg_springback_fit *fit) {
  double left = fg_splitmix_uniform(&drawer->state);
  size_t i = 0;
  while (i + 1 < fit->points && left > fit->point[i].weight)
    left -= fit->point[i++].weight;
  return &fit->point[i];
}

static double log_die_size(const fg_die_dimensions *die, fg_formed formed, size_t place) {
  if (formed == FG_FORMED_OVERALL) return log(die->overall_radius_mm);
  if (formed == FG_FORMED_PITCH) return log(die->pitch_deg);
  double arc = formed == FG_FORMED_ARC_LENGTH ? die->bump[place].bump_angle_deg / 180 * M_PI : 1;
  return log(die->bump[place].radius_mm * arc);
}

static void draw_quantity(fg_drawer *drawer, fg_formed formed, fg_drawn_process *process) {
  const fg_springback_fit *fit = &drawer->laws->of[formed];
  double normal[FG_COMPENSATION_BUMPS + 3], state[FG_COMPENSATION_BUMPS + 3];
  if (!fit->points) return;
  const fg_springback_point *point = draw_point(drawer, fit);
  for (size_t i = 0; i < fit->states; i++) {
    normal[i] = fg_splitmix_normal(&drawer->state);
    state[i] = point->mean[i];
    for (size_t k = 0; k <= i; k++)
      state[i] += point->root[i * fit->states + k] * normal[k];
  }
  process->sizes[formed] = point->sizes;
  for (size_t place = 0; place < fit->places; place++) {
    double die = log_die_size(drawer->die, formed, place);
    process->log_size[formed][place] = die + state[FG_STATE_COMMON] +
                                       state[FG_STATE_EXPONENT] * (die - fit->reference) +
                                       state[FG_STATE_BUMP + place] + state[fit->states - 1];
  }
}

void fg_draw_process(fg_drawer *drawer, fg_drawn_process *process) {
  for (int q = 0; q < FG_FORMED; q++)
    draw_quantity(drawer, (fg_formed)q, process);
}

/* Angle and height of the circles: R0² = X² + R² - 2 X R cos(alpha / 2). */
static void derive_foil(const fg_die_dimensions *die, fg_drawn_foil *foil) {
  double r0 = foil->overall_radius_mm;
  for (size_t i = 0; i < die->bumps; i++) {
    double r = foil->radius_mm[i], half = foil->angle_deg[i] / 360 * M_PI;
    double chord = r * sin(half), x = r * cos(half) + sqrt(fmax(0, r0 * r0 - chord * chord));
    foil->height_mm[i] = r0 - x + r;
  }
}

/* A foil with these deviations of its logarithms; NULL: none. */
static void make_drawn_foil(const fg_drawer *drawer, const fg_drawn_process *process,
                            const fg_formed_foil *deviation, fg_drawn_foil *foil) {
  const double *radius = process->log_size[FG_FORMED_RADIUS],
               *arc = process->log_size[FG_FORMED_ARC_LENGTH];
  foil->overall_radius_mm =
      exp(process->log_size[FG_FORMED_OVERALL][0] + (deviation ? deviation->overall : 0));
  foil->pitch_deg = exp(process->log_size[FG_FORMED_PITCH][0] + (deviation ? deviation->pitch : 0));
  for (size_t i = 0; i < drawer->die->bumps; i++) {
    double length = exp(arc[i] + (deviation ? deviation->log_ratio[1][i] : 0));
    foil->radius_mm[i] = exp(radius[i] + (deviation ? deviation->log_ratio[0][i] : 0));
    foil->angle_deg[i] = length / foil->radius_mm[i] * 180 / M_PI;
  }
  derive_foil(drawer->die, foil);
}

void fg_process_foil(const fg_drawer *drawer, const fg_drawn_process *process,
                     fg_drawn_foil *foil) {
  make_drawn_foil(drawer, process, NULL, foil);
}

/* Normal deviations of the mean of `foils` foils. */
static void draw_deviation(fg_drawer *drawer, const fg_drawn_process *process, double foils,
                           fg_formed_foil *deviation) {
  double share = 1 / sqrt(foils);
  for (int q = 0; q < 2; q++) {
    double level = share * process->sizes[q].foil * fg_splitmix_normal(&drawer->state);
    for (size_t i = 0; i < drawer->die->bumps; i++)
      deviation->log_ratio[q][i] =
          level + share * process->sizes[q].rest * fg_splitmix_normal(&drawer->state);
  }
  deviation->overall =
      share * process->sizes[FG_FORMED_OVERALL].foil * fg_splitmix_normal(&drawer->state);
  deviation->pitch =
      share * process->sizes[FG_FORMED_PITCH].foil * fg_splitmix_normal(&drawer->state);
}

void fg_draw_mean(fg_drawer *drawer, const fg_drawn_process *process, double foils,
                  fg_drawn_foil *foil) {
  fg_formed_foil deviation;
  draw_deviation(drawer, process, foils, &deviation);
  make_drawn_foil(drawer, process, &deviation, foil);
}

void fg_draw_foil(fg_drawer *drawer, const fg_drawn_process *process, fg_drawn_foil *foil) {
  fg_formed_foil deviation;
  draw_deviation(drawer, process, 1, &deviation);
  if (drawer->deviations) {
    double at = fg_splitmix_uniform(&drawer->state) * (double)drawer->deviations;
    const fg_formed_foil *seen = &drawer->deviation[(size_t)at];
    for (int q = 0; q < 2; q++)
      for (size_t i = 0; i < drawer->die->bumps; i++)
        if (isfinite(seen->log_ratio[q][i])) deviation.log_ratio[q][i] = seen->log_ratio[q][i];
    if (isfinite(seen->overall)) deviation.overall = seen->overall;
    if (isfinite(seen->pitch)) deviation.pitch = seen->pitch;
  }
  make_drawn_foil(drawer, process, &deviation, foil);
}
