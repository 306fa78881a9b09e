/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two models of a scanner held against each other. */
#include "foilgauge/scanner_change.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/select.h"
#include "core/text.h"
#include "scan_loop/scanner_model.h"

/* A displacement over the places: x and y by turns without their straight part, then that as scale,
 * ratio and shear. So the uncertainty of a plate's pitch stays with the numbers. */
enum {
  PLACES = FG_SCANNER_SIDE * FG_SCANNER_SIDE,
  MOVES = 2 * PLACES + FG_SCANNER_NUMBERS,
  AFFINE = 6,
  SOURCES_MAX = 2 * (FG_MODEL_NUMBERS_MAX + FG_EXPLANATIONS_MAX)
};
enum { DRAWS = 4000, SEED = 1 };
#define CHANGED_P   0.01
#define SUSPECTED_P 0.1
/* A region of fewer mm is no bed. Less than a nanometre is rounding. */
#define COMMON_MIN_MM 2.0
#define ROUNDING_MM   1e-6

typedef struct change_work {
  fg_scanner_change *change;
  const fg_scanner_model *model[2]; /* older, newer */
  size_t places;
  double own[2][MOVES];   /* by each model */
  double u_own[2][MOVES]; /* their squares, until the end */
  double *source;         /* owned; MOVES each: a standard deviation of independent errors */
  size_t sources;
} change_work;

/* ---- places ---- */

static fg_status find_common_region(fg_context *ctx, const fg_scanner_model *const model[2],
                                    fg_scanner_change *change) {
  for (int axis = 0; axis < 2; axis++) {
    const fg_field_frame *a = &model[0]->fields.frame, *b = &model[1]->fields.frame;
    if (fabs(model[0]->dpi[axis] / model[1]->dpi[axis] - 1) > 1e-4)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s is of a scanner at %g dpi and %s at %g dpi: compare models of one "
                     "resolution",
                     model[0]->path, model[0]->dpi[axis], model[1]->path, model[1]->dpi[axis]);
    change->low_mm[axis] = fmax(a->low_mm[axis], b->low_mm[axis]);
    change->high_mm[axis] = fmin(a->high_mm[axis], b->high_mm[axis]);
    if (change->high_mm[axis] - change->low_mm[axis] < COMMON_MIN_MM)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s and %s know no common part of the glass: make the models of scans that "
                     "lie alike",
                     model[0]->path, model[1]->path);
  }
  return FG_OK;
}

static void lay_places(fg_scanner_change *change) {
  double size[2] = {change->high_mm[0] - change->low_mm[0], change->high_mm[1] - change->low_mm[1]};
  double longer = fmax(size[0], size[1]);
  change->columns = (size_t)fmax(3, ceil(FG_SCANNER_SIDE * size[0] / longer - 1e-9));
  change->rows = (size_t)fmax(3, ceil(FG_SCANNER_SIDE * size[1] / longer - 1e-9));
  change->places = change->columns * change->rows;
  for (size_t k = 0; k < change->places; k++) {
    double i = (double)(k % change->columns), j = (double)(k / change->columns);
    change->place[k].at_mm =
        (fg_point){change->low_mm[0] + size[0] * i / (double)(change->columns - 1),
                   change->low_mm[1] + size[1] * j / (double)(change->rows - 1)};
    change->place[k].compared = true;
  }
}

static fg_point displace_by_field(const fg_field_list *list, const fg_field *field, fg_point at) {
  const fg_field_list one = {.frame = list->frame, .fields = {*field}, .count = 1};
  return fg_field_at(&one, at);
}

/* Has the other model the jump elsewhere, so that the place lies between both? */
static bool is_between_jumps(const change_work *work, fg_point at) {
  for (size_t i = 0; i < work->model[0]->fields.count; i++)
    for (size_t k = 0; k < work->model[1]->fields.count; k++) {
      const fg_field *a = &work->model[0]->fields.fields[i];
      const fg_field *b = &work->model[1]->fields.fields[k];
      if (strcmp(a->id, b->id) != 0 || !fg_effect_find(a->id)->jumps) continue;
      fg_point p = displace_by_field(&work->model[0]->fields, a, at);
      fg_point q = displace_by_field(&work->model[1]->fields, b, at);
      if (hypot(p.x - q.x, p.y - q.y) > 0.5 * fabs(a->amplitude_mm[0])) return true;
    }
  return false;
}

/* Leaves places between jumps out, unless that were most of them. */
static void leave_jumps_out(const change_work *work) {
  fg_scanner_change *change = work->change;
  size_t left = 0;
  for (size_t k = 0; k < change->places; k++) {
    change->place[k].compared = !is_between_jumps(work, change->place[k].at_mm);
    left += change->place[k].compared;
  }
  for (size_t k = 0; 2 * left < change->places && k < change->places; k++)
    change->place[k].compared = true;
}

/* ---- displacements ---- */

static fg_point off_middle(const fg_scanner_change *change, size_t k) {
  fg_point at = change->place[k].at_mm;
  return (fg_point){at.x - 0.5 * (change->low_mm[0] + change->high_mm[0]),
                    at.y - 0.5 * (change->low_mm[1] + change->high_mm[1])};
}

/* Straight part of a displacement over the places: d = (a0 + a1 x + a2 y, b0 + b1 x + b2 y) about
 * the middle, where the three are orthogonal. */
static void fit_straight(const fg_scanner_change *change, const double *moves,
                         double straight[AFFINE]) {
  double square[3] = {0}, dot[AFFINE] = {0};
  for (size_t k = 0; k < change->places; k++) {
    fg_point at = off_middle(change, k);
    const double shape[3] = {1, at.x, at.y};
    for (int s = 0; s < 3; s++) {
      square[s] += shape[s] * shape[s];
      dot[s] += shape[s] * moves[2 * k];
      dot[3 + s] += shape[s] * moves[2 * k + 1];
    }
  }
  for (int s = 0; s < AFFINE; s++)
    straight[s] = dot[s] / square[s % 3];
}

/* Takes the straight part off the moves and appends its numbers; shift and turn have no meaning.
 * True is measured plus d: where d stretches a length, the scanner reads it too short. */
static void finish_moves(const fg_scanner_change *change, double *moves) {
  double s[AFFINE];
  fit_straight(change, moves, s);
  for (size_t k = 0; k < change->places; k++) {
    fg_point at = off_middle(change, k);
    moves[2 * k] -= s[0] + s[1] * at.x + s[2] * at.y;
    moves[2 * k + 1] -= s[3] + s[4] * at.x + s[5] * at.y;
  }
  double *number = moves + 2 * change->places;
  number[0] = -0.5 * (s[1] + s[5]);
  number[1] = s[5] - s[1];
  number[2] = s[2] + s[4];
}

/* Displacement of a place with the numbers, less shift and turn, and less the scale where it is not
 * known. */
static fg_point find_whole_move(const fg_scanner_change *change, const double *moves, size_t k) {
  const double *number = moves + 2 * change->places;
  double scale = change->scale_known ? -number[0] : 0;
  fg_point at = off_middle(change, k);
  return (fg_point){moves[2 * k] + (scale - 0.5 * number[1]) * at.x + 0.5 * number[2] * at.y,
                    moves[2 * k + 1] + 0.5 * number[2] * at.x + (scale + 0.5 * number[1]) * at.y};
}

static void find_displacement(const fg_scanner_change *change, const fg_field_list *list,
                              double moves[MOVES]) {
  for (size_t k = 0; k < change->places; k++) {
    fg_point d = fg_field_at(list, change->place[k].at_mm);
    moves[2 * k] = d.x;
    moves[2 * k + 1] = d.y;
  }
  finish_moves(change, moves);
}

/* Adds an independent error of a model: the difference of a displacement from its own, of a share.
 */
static void add_source(change_work *work, size_t of, const fg_field_list *list, double share) {
  if (work->sources == SOURCES_MAX) return;
  double *moves = work->source + work->sources++ * MOVES;
  size_t n = 2 * work->places + FG_SCANNER_NUMBERS;
  find_displacement(work->change, list, moves);
  for (size_t i = 0; i < n; i++) {
    moves[i] = share * (moves[i] - work->own[of][i]);
    work->u_own[of][i] += moves[i] * moves[i];
  }
}

static void add_numbers(change_work *work, size_t of) {
  const fg_field_list *list = &work->model[of]->fields;
  for (size_t f = 0; f < list->count; f++)
    for (size_t k = 0; k < list->fields[f].columns + list->fields[f].shapes; k++) {
      fg_field_list moved = *list;
      fg_field *field = &moved.fields[f];
      bool amplitude = k < field->columns;
      size_t s = amplitude ? k : k - field->columns;
      double u = amplitude ? field->u_amplitude_mm[s] : field->u_shape[s];
      if (!(u > 0)) continue;
      *(amplitude ? &field->amplitude_mm[s] : &field->shape[s]) += u;
      add_source(work, of, &moved, 1);
    }
}

static fg_status add_modes(fg_context *ctx, change_work *work, size_t of) {
  const fg_field_map *map = &work->model[of]->map;
  size_t numbers = 2 * fg_map_splines(&map->frame);
  fg_field_list moved = work->model[of]->fields;
  double *mm;
  if (!map->mode_count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof *mm, (void **)&mm));
  moved.map_mm = mm;
  for (size_t k = 0; k < map->mode_count; k++) {
    for (size_t i = 0; i < numbers; i++)
      mm[i] = map->mm[i] + map->modes[k][i];
    add_source(work, of, &moved, 1);
  }
  free(mm);
  return FG_OK;
}

static fg_status describe_models(fg_context *ctx, change_work *work) {
  for (size_t of = 0; of < 2; of++) {
    const fg_scanner_model *model = work->model[of];
    find_displacement(work->change, &model->fields, work->own[of]);
    add_numbers(work, of);
    FG_TRY(add_modes(ctx, work, of));
    for (size_t k = 0; k < model->others; k++)
      add_source(work, of, &model->other[k], sqrt(fg_scanner_model_weight(model, k + 1)));
  }
  return FG_OK;
}

/* ---- the test ---- */

static bool is_compared(const change_work *work, size_t i) {
  if (i < 2 * work->places) return work->change->place[i / 2].compared;
  return i > 2 * work->places || work->change->scale_known;
}

/* Standard uncertainty of a difference: of both models. */
static double find_u_of(const change_work *work, size_t i) {
  return sqrt(work->u_own[0][i] + work->u_own[1][i]);
}

/* (difference / u)²; infinite where both models claim to know it exactly and differ. */
static double find_z2(const change_work *work, const double *difference, size_t i,
                      double rounding) {
  double u = find_u_of(work, i), size = fabs(difference[i]);
  if (size < rounding) return 0;
  return u > 0 ? size * size / (u * u) : INFINITY;
}

/* Two statistics: mean z² of all places, which a place whose u is too small does not lead; and the
 * largest z² of the numbers. */
typedef struct change_statistics {
  double places, numbers;
} change_statistics;

static change_statistics find_statistics(const change_work *work, const double *difference) {
  change_statistics s = {0, 0};
  double count = 0;
  size_t first = 2 * work->places;
  for (size_t i = 0; i < first + FG_SCANNER_NUMBERS; i++) {
    if (!is_compared(work, i)) continue;
    double z2 = find_z2(work, difference, i, i < first ? ROUNDING_MM : 1e-3 * ROUNDING_MM);
    if (i < first) {
      s.places += z2;
      count++;
    } else {
      s.numbers = fmax(s.numbers, z2);
    }
  }
  s.places /= count;
  return s;
}

/* Statistics of one draw of both models' errors. */
static change_statistics draw_statistics(const change_work *work, gsl_rng *random, double *sum) {
  size_t n = 2 * work->places + FG_SCANNER_NUMBERS;
  memset(sum, 0, n * sizeof *sum);
  for (size_t s = 0; s < work->sources; s++) {
    const double *moves = work->source + s * MOVES;
    double error = gsl_ran_gaussian_ziggurat(random, 1);
    for (size_t i = 0; i < n; i++)
      sum[i] += error * moves[i];
  }
  return find_statistics(work, sum);
}

/* The smaller of both probabilities, twice (Bonferroni). `critical` gets the mean z² of places that
 * is just called a change. */
static fg_status test_change(fg_context *ctx, const change_work *work, change_statistics found,
                             double *critical) {
  double sum[MOVES], *z2, beyond[2] = {1, 1};
  fg_numerics_start();
  FG_TRY(fg_memory_allocate(ctx, DRAWS, sizeof *z2, (void **)&z2));
  gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
  if (!random) {
    free(z2);
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  }
  gsl_rng_set(random, SEED);
  for (size_t d = 0; d < DRAWS; d++) {
    change_statistics drawn = draw_statistics(work, random, sum);
    z2[d] = drawn.places;
    beyond[0] += drawn.places >= found.places;
    beyond[1] += drawn.numbers >= found.numbers;
  }
  fg_sort(z2, DRAWS);
  *critical = z2[(size_t)((1 - CHANGED_P / 2) * DRAWS)];
  work->change->p_value = fmin(1, 2 * fmin(beyond[0], beyond[1]) / (1 + (double)DRAWS));
  gsl_rng_free(random);
  free(z2);
  return FG_OK;
}

/* ---- the result ---- */

/* Returns true when a model holds the number: what both leave out is no 0 that they know. */
static bool is_held(const change_work *work, size_t i) {
  double rounding = 1e-3 * ROUNDING_MM;
  return find_u_of(work, i) > rounding || fabs(work->own[0][i]) + fabs(work->own[1][i]) > rounding;
}

static void tell_numbers(const change_work *work, const double *difference) {
  static const char *const ids[FG_SCANNER_NUMBERS] = {"scale", "axis_ratio", "shear"};
  static const char *const words[FG_SCANNER_NUMBERS] = {
      "a length, as measured, over the true one, less 1; mean of both axes",
      "the same along x over that along y, less 1", "shift along x per length along y"};
  fg_scanner_change *change = work->change;
  change->numbers = FG_SCANNER_NUMBERS;
  for (size_t k = 0; k < FG_SCANNER_NUMBERS; k++) {
    size_t i = 2 * work->places + k;
    double known = is_compared(work, i) && is_held(work, i) ? 1 : NAN;
    change->number[k] = (fg_scanner_number){.id = ids[k],
                                            .words = words[k],
                                            .older = known * work->own[0][i],
                                            .newer = known * work->own[1][i],
                                            .u_older = known * sqrt(work->u_own[0][i]),
                                            .u_newer = known * sqrt(work->u_own[1][i]),
                                            .difference = known * difference[i],
                                            .u = known * find_u_of(work, i)};
  }
}

/* Uncertainties of a place's difference along x, along y and along a direction, um. */
static fg_point find_u_of_place(const change_work *work, size_t k, fg_point direction,
                                double *along_um) {
  double x = 0, y = 0, along = 0;
  for (size_t s = 0; s < work->sources; s++) {
    fg_point d = find_whole_move(work->change, work->source + s * MOVES, k);
    double dot = d.x * direction.x + d.y * direction.y;
    x += d.x * d.x;
    y += d.y * d.y;
    along += dot * dot;
  }
  *along_um = 1000 * sqrt(along);
  return (fg_point){1000 * sqrt(x), 1000 * sqrt(y)};
}

static void tell_places(const change_work *work, const double *difference, double critical) {
  fg_scanner_change *change = work->change;
  double square = 0, count = 0, u[2 * PLACES];
  size_t n = 0;
  for (size_t k = 0; k < change->places; k++) {
    fg_scanner_place *place = &change->place[k];
    fg_point d = find_whole_move(change, difference, k);
    double size = 1000 * hypot(d.x, d.y), along_um;
    fg_point direction = size > 0 ? (fg_point){1000 * d.x / size, 1000 * d.y / size} : d;
    place->d_um = (fg_point){1000 * d.x, 1000 * d.y};
    place->u_um = find_u_of_place(work, k, direction, &along_um);
    if (!place->compared) continue;
    square += size * size;
    count += 2;
    u[n++] = 1000 * find_u_of(work, 2 * k);
    u[n++] = 1000 * find_u_of(work, 2 * k + 1);
    if (size <= change->largest_um) continue;
    change->largest = *place;
    change->largest_um = size;
    change->u_largest_um = along_um;
  }
  change->rms_um = sqrt(square / count);
  fg_sort(u, n);
  change->would_show_um = critical > 0 ? sqrt(critical) * u[n / 2] : NAN;
}

static fg_scanner_limit judge_limit(const fg_scanner_change *change) {
  double expanded = 2 * change->u_largest_um;
  if (!isfinite(change->limit_um)) return FG_SCANNER_NO_LIMIT;
  if (change->largest_um + expanded <= change->limit_um) return FG_SCANNER_WITHIN;
  return change->largest_um - expanded > change->limit_um ? FG_SCANNER_BEYOND
                                                          : FG_SCANNER_CANNOT_TELL;
}

static void put_limit_words(fg_scanner_change *change) {
  static const char *const words[] = {
      [FG_SCANNER_WITHIN] = "That is within the allowed %g µm.",
      [FG_SCANNER_BEYOND] = "That is more than the allowed %g µm.",
      [FG_SCANNER_CANNOT_TELL] = ("Whether that is within the allowed %g µm cannot be told: the "
                                  "limit lies within U."),
  };
  size_t used = strlen(change->sentence);
  char limit[120];
  if (change->limit == FG_SCANNER_NO_LIMIT) return;
  const char *text = words[change->limit], *number = strstr(text, "%g");
  fg_text_clip(limit, sizeof limit, "%.*s%g%s", (int)(number - text), text, change->limit_um,
               number + 2);
  fg_text_clip(change->sentence + used, sizeof change->sentence - used, " %s", limit);
}

static void write_change_sentence(fg_scanner_change *change) {
  static const char *const verdicts[] = {
      [FG_SCANNER_SAME] = "No change of the scanner shows",
      [FG_SCANNER_SUSPECTED] = "The scanner may have changed",
      [FG_SCANNER_CHANGED] = "The scanner has changed",
  };
  char shows[160] = " Neither model holds more than scale, ratio and shear: a change of shape "
                    "was not looked for.";
  if (isfinite(change->would_show_um))
    fg_text_clip(shows, sizeof shows,
                 " Beside scale, ratio and shear, %.2f µm rms over the bed would have shown.",
                 change->would_show_um);
  fg_text_clip(change->sentence, sizeof change->sentence,
               "%s (p = %.2g): the models differ by at most %.2f ± %.2f µm over %.0f × %.0f mm.%s",
               verdicts[change->verdict], change->p_value, change->largest_um,
               2 * change->u_largest_um, change->high_mm[0] - change->low_mm[0],
               change->high_mm[1] - change->low_mm[1], shows);
  put_limit_words(change);
}

static fg_status finish_change(fg_context *ctx, change_work *work) {
  fg_scanner_change *change = work->change;
  double difference[MOVES], critical = 0;
  for (size_t i = 0; i < 2 * work->places + FG_SCANNER_NUMBERS; i++)
    difference[i] = work->own[1][i] - work->own[0][i];
  FG_TRY(test_change(ctx, work, find_statistics(work, difference), &critical));
  tell_numbers(work, difference);
  tell_places(work, difference, critical);
  change->verdict = change->p_value < CHANGED_P     ? FG_SCANNER_CHANGED
                    : change->p_value < SUSPECTED_P ? FG_SCANNER_SUSPECTED
                                                    : FG_SCANNER_SAME;
  change->limit = judge_limit(change);
  write_change_sentence(change);
  return FG_OK;
}

static fg_status check_names(fg_context *ctx, const fg_scanner_model *older,
                             const fg_scanner_model *newer) {
  if (!older->scanner[0] || !newer->scanner[0] || !strcmp(older->scanner, newer->scanner))
    return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s is of the scanner '%s' and %s of '%s'", older->path,
                 older->scanner, newer->path, newer->scanner);
}

fg_status fg_scanner_compare(fg_context *ctx, const fg_scanner_model *older,
                             const fg_scanner_model *newer, double limit_um,
                             fg_scanner_change *change) {
  change_work *work = NULL;
  *change = (fg_scanner_change){.limit_um = limit_um};
  FG_TRY(check_names(ctx, older, newer));
  FG_TRY(find_common_region(ctx, (const fg_scanner_model *[]){older, newer}, change));
  change->scale_known = (older->known_grids || older->known_diameters) &&
                        (newer->known_grids || newer->known_diameters);
  fg_scanner_model_describe(older, &change->older);
  fg_scanner_model_describe(newer, &change->newer);
  lay_places(change);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work, (void **)&work));
  *work = (change_work){.change = change, .model = {older, newer}, .places = change->places};
  fg_status status = fg_memory_allocate(ctx, (size_t)SOURCES_MAX * MOVES, sizeof *work->source,
                                        (void **)&work->source);
  leave_jumps_out(work);
  if (status == FG_OK) status = describe_models(ctx, work);
  if (status == FG_OK) status = finish_change(ctx, work);
  free(work->source);
  free(work);
  return status;
}

int fg_scanner_change_exit_code(const fg_scanner_change *change) {
  if (change->limit != FG_SCANNER_NO_LIMIT)
    return change->limit == FG_SCANNER_WITHIN ? 0 : change->limit == FG_SCANNER_BEYOND ? 1 : 3;
  return change->verdict == FG_SCANNER_SAME ? 0 : change->verdict == FG_SCANNER_CHANGED ? 1 : 3;
}
