#include "scan_loop/pays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* A correction of less than this share of what a value is uncertain by anyway, with its doubt,
 * changes u by half a percent: nothing is decided about it. */
#define SMALL_SHARE 0.1
/* m² > 2 u² (see the header). */
#define PAYS_RATIO 2.0

static bool is_measured(const fg_foil *foil) {
  return !(foil->flags & FG_FOIL_NOT_MEASURED);
}

static fg_status open_items(fg_context *ctx, size_t count, fg_pay *pay) {
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *pay->item, (void **)&pay->item));
  pay->items = count;
  return FG_OK;
}

static fg_status open_foil(fg_context *ctx, const fg_foil *foil, fg_pay *pay) {
  FG_TRY(open_items(ctx, foil->bump_count + 1, pay));
  for (size_t i = 0; i < pay->items; i++) {
    const fg_bump *bump = i < foil->bump_count ? &foil->bumps[i] : NULL;
    pay->item[i].u[FG_CORRECTED_OVERALL_RADIUS] = foil->overall.u_radius_mm;
    pay->item[i].u[FG_CORRECTED_RADIUS] = bump ? bump->u_radius_mm : NAN;
    pay->item[i].u[FG_CORRECTED_HEIGHT] = bump ? bump->u_height_mm : NAN;
  }
  return FG_OK;
}

fg_status fg_pays_open(fg_context *ctx, const fg_measurement *before, fg_pays *pays) {
  fg_status status = FG_OK;
  *pays = (fg_pays){.foil = NULL};
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, before->foil_count, sizeof *pays->foil, (void **)&pays->foil));
  for (; pays->foils < before->foil_count; pays->foils++)
    FG_TRY_EXIT(open_foil(ctx, &before->foils[pays->foils], &pays->foil[pays->foils]));
  FG_TRY_EXIT(open_items(ctx, before->disc_count, &pays->discs));
  for (size_t d = 0; d < before->disc_count; d++)
    for (int k = 0; k < FG_CORRECTED; k++)
      pays->discs.item[d].u[k] = k == FG_CORRECTED_RADIUS ? before->discs[d].u_radius_mm : NAN;
exit:
  if (status != FG_OK) fg_pays_close(pays);
  return status;
}

void fg_pays_close(fg_pays *pays) {
  for (size_t f = 0; f < pays->foils; f++)
    free(pays->foil[f].item);
  free(pays->foil);
  free(pays->discs.item);
  *pays = (fg_pays){.foil = NULL};
}

/* ---- moves ---- */

static bool same_bumps(const fg_foil *a, const fg_foil *b) {
  if (!is_measured(a) || !is_measured(b) || a->bump_count != b->bump_count) return false;
  for (size_t i = 0; i < a->bump_count; i++)
    if (a->bumps[i].number != b->bumps[i].number) return false;
  return true;
}

/* From one measurement of a foil to another; behind the bumps R0 alone. */
static void moves_of(const fg_foil *from, const fg_foil *to, size_t item,
                     double move[FG_CORRECTED]) {
  bool bump = item < from->bump_count;
  move[FG_CORRECTED_OVERALL_RADIUS] = to->overall.radius_mm - from->overall.radius_mm;
  move[FG_CORRECTED_RADIUS] = bump ? to->bumps[item].radius_mm - from->bumps[item].radius_mm : NAN;
  move[FG_CORRECTED_HEIGHT] = bump ? to->bumps[item].height_mm - from->bumps[item].height_mm : NAN;
}

static void add_foil(fg_pay *pay, const fg_foil *before, const fg_foil *corrected) {
  if (!is_measured(before) || pay->lost || pay->explanations == FG_PAYS_EXPLANATIONS_MAX) return;
  if (!same_bumps(before, corrected)) {
    pay->lost = !pay->explanations; /* another explanation that is lost says nothing */
    return;
  }
  size_t at = pay->explanations++;
  pay->centre[at] = (fg_point){corrected->overall.centre_mm.x - before->overall.centre_mm.x,
                               corrected->overall.centre_mm.y - before->overall.centre_mm.y};
  for (size_t i = 0; i < pay->items; i++) {
    moves_of(before, corrected, i, pay->item[i].move[at]);
    if (i < before->bump_count)
      pay->item[i].turn_deg[at] =
          remainder(corrected->bumps[i].position_deg - before->bumps[i].position_deg, 360);
  }
}

static void add_discs(fg_pay *pay, const fg_measurement *before, const fg_measurement *corrected) {
  if (pay->explanations == FG_PAYS_EXPLANATIONS_MAX) return;
  size_t at = pay->explanations++;
  for (size_t d = 0; d < pay->items; d++)
    for (int k = 0; k < FG_CORRECTED; k++)
      pay->item[d].move[at][k] = k == FG_CORRECTED_RADIUS
                                     ? corrected->discs[d].radius_mm - before->discs[d].radius_mm
                                     : NAN;
}

void fg_pays_add(fg_pays *pays, const fg_measurement *before, const fg_measurement *corrected) {
  for (size_t f = 0; f < pays->foils; f++)
    add_foil(&pays->foil[f], &before->foils[f], &corrected->foils[f]);
  add_discs(&pays->discs, before, corrected);
}

/* ---- noise ---- */

void fg_pay_add_noise(fg_pay *pay, size_t item, double noise[FG_CORRECTED][FG_CORRECTED]) {
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++)
      pay->item[item].noise[a][b] += noise[a][b];
}

static void add_step(fg_pay *pay, size_t item, const double step[FG_CORRECTED]) {
  double noise[FG_CORRECTED][FG_CORRECTED];
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++)
      noise[a][b] = isfinite(step[a] * step[b]) ? step[a] * step[b] : 0;
  fg_pay_add_noise(pay, item, noise);
}

void fg_pays_add_step(fg_pays *pays, const fg_measurement *corrected,
                      const fg_measurement *stepped) {
  double step[FG_CORRECTED] = {0};
  for (size_t f = 0; f < pays->foils; f++) {
    const fg_foil *from = &corrected->foils[f], *to = &stepped->foils[f];
    if (!same_bumps(from, to)) continue;
    pays->foil[f].noises = 1;
    for (size_t i = 0; i < pays->foil[f].items && i <= from->bump_count; i++) {
      moves_of(from, to, i, step);
      add_step(&pays->foil[f], i, step);
    }
  }
  for (size_t d = 0; d < pays->discs.items; d++) {
    memset(step, 0, sizeof step);
    step[FG_CORRECTED_RADIUS] = stepped->discs[d].radius_mm - corrected->discs[d].radius_mm;
    pays->discs.noises = 1;
    add_step(&pays->discs, d, step);
  }
}

/* ---- the rule ---- */

void fg_pay_mean(const fg_pay *pay, size_t item, double mean[FG_CORRECTED]) {
  for (int k = 0; k < FG_CORRECTED; k++) {
    mean[k] = pay->explanations ? 0 : NAN;
    for (size_t e = 0; e < pay->explanations; e++)
      mean[k] += pay->item[item].move[e][k] / (double)pay->explanations;
  }
}

static double noise_of(const fg_pay *pay, size_t item, int a, int b) {
  return pay->noises > 0 ? pay->item[item].noise[a][b] / pay->noises : 0;
}

/* Sums over items, mm²: of the mean move, of its noise, of the scatter of the explanations, of the
 * value's own u; of what is left by and what is moved by every explanation. */
typedef struct sums {
  double items, move, noise, scatter, own;
  double left[FG_PAYS_EXPLANATIONS_MAX], size[FG_PAYS_EXPLANATIONS_MAX];
  size_t explanations;
} sums;

static void sum_up(const fg_pay *pay, int k, sums *s) {
  if (pay->explanations > s->explanations) s->explanations = pay->explanations;
  for (size_t i = 0; i < pay->items; i++) {
    double mean[FG_CORRECTED];
    fg_pay_mean(pay, i, mean);
    if (!isfinite(mean[k])) continue;
    s->items++;
    s->move += mean[k] * mean[k];
    s->noise += noise_of(pay, i, k, k);
    s->own += pay->item[i].u[k] * pay->item[i].u[k];
    for (size_t e = 0; e < pay->explanations; e++) {
      double one = pay->item[i].move[e][k], off = one - mean[k];
      s->scatter += off * off / (double)pay->explanations;
      s->left[e] += off * off;
      s->size[e] += one * one;
    }
  }
}

static bool brings_nearer(const sums *s) {
  for (size_t e = 0; e < s->explanations; e++)
    if (!(s->left[e] < s->size[e])) return false;
  return true;
}

static fg_correction_reason judge(const sums *s) {
  double doubt = s->noise + s->scatter;
  if (s->items < 1) return FG_CORRECTION_NONE;
  if (s->move + doubt <= SMALL_SHARE * SMALL_SHARE * s->own) return FG_CORRECTION_SMALL;
  if (!(s->move > PAYS_RATIO * doubt))
    return s->scatter > s->noise ? FG_CORRECTION_TIED : FG_CORRECTION_DOUBTFUL;
  return brings_nearer(s) ? FG_CORRECTION_PAYS : FG_CORRECTION_TIED;
}

/* The first item of R0 has its sign; of many values the root of the mean square. */
static void tell(const fg_pay *pay, int k, fg_correction_choice *choice) {
  sums s = {.items = 0};
  double mean[FG_CORRECTED];
  sum_up(pay, k, &s);
  choice->move_mm = sqrt(s.move / s.items);
  choice->u_move_mm = sqrt((s.noise + s.scatter) / s.items);
  if (k != FG_CORRECTED_OVERALL_RADIUS || !pay->items) return;
  fg_pay_mean(pay, pay->items - 1, mean);
  choice->move_mm = mean[k];
}

void fg_pay_decide(const fg_pay *const *pay, size_t count, fg_correction_choice *const *choice) {
  fg_correction_reason reason[FG_CORRECTED];
  bool moved = false, left = false, lost = false;
  for (size_t i = 0; i < count; i++)
    lost = lost || pay[i]->lost;
  for (int k = 0; k < FG_CORRECTED; k++) {
    sums s = {.items = 0};
    for (size_t i = 0; i < count; i++)
      sum_up(pay[i], k, &s);
    reason[k] = lost ? FG_CORRECTION_LOST : judge(&s);
    moved = moved || reason[k] == FG_CORRECTION_PAYS;
    left = left || reason[k] >= FG_CORRECTION_DOUBTFUL;
  }
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < FG_CORRECTED; k++) {
      bool along = reason[k] == FG_CORRECTION_SMALL && (moved || !left);
      choice[i][k] = (fg_correction_choice){.reason = reason[k],
                                            .moved = reason[k] == FG_CORRECTION_PAYS || along};
      tell(pay[i], k, &choice[i][k]);
    }
}

void fg_pay_moment(const fg_pay *pay, size_t item, const fg_correction_choice *choice,
                   double moment[FG_CORRECTED][FG_CORRECTED]) {
  double mean[FG_CORRECTED];
  fg_pay_mean(pay, item, mean);
  for (int k = 0; k < FG_CORRECTED; k++)
    if (!choice[k].moved) mean[k] = 0;
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++) {
      moment[a][b] = noise_of(pay, item, a, b);
      for (size_t e = 0; e < pay->explanations; e++) {
        const double *move = pay->item[item].move[e];
        double product = (move[a] - mean[a]) * (move[b] - mean[b]);
        if (isfinite(product)) moment[a][b] += product / (double)pay->explanations;
      }
    }
}

bool fg_pay_is_whole(const fg_pay *pay, const fg_correction_choice choice[FG_CORRECTED]) {
  if (pay->explanations > 1 || pay->misfit || pay->lost) return false;
  for (int k = 0; k < FG_CORRECTED; k++)
    if (!choice[k].moved && choice[k].reason != FG_CORRECTION_NONE) return false;
  return true;
}
