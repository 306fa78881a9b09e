/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Order of the lots by date, their designs, and the axes of their quantities. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "lots/index.h"

/* Two quantities are equivalent when their values over all foils lie on one line; the residual is
 * the tenth digit of the tables. */
#define ON_ONE_LINE 1e-9

/* Sorts by date, name and given order; lots without a date come later, unread ones last. */
static int compare_dates(const void *left, const void *right) {
  const fg_index_lot *a = left, *b = right;
  if (!a->problem != !b->problem) return a->problem ? 1 : -1;
  if (isnan(a->day) != isnan(b->day)) return isnan(a->day) ? 1 : -1;
  if (a->day != b->day && !isnan(a->day)) return a->day < b->day ? -1 : 1;
  int last = strcmp(a->date.last, b->date.last);
  if (last) return last;
  int names = a->name && b->name ? strcmp(a->name, b->name) : 0;
  return names ? names : strcmp(a->folder, b->folder);
}

static void number_designs(fg_index *index) {
  for (size_t i = 0; i < index->read; i++) {
    fg_index_lot *lot = &index->lots[i];
    for (size_t k = 0; k < i && !lot->design_number; k++)
      if (!strcmp(index->lots[k].design_sum, lot->design_sum))
        lot->design_number = index->lots[k].design_number;
    if (!lot->design_number) lot->design_number = ++index->designs;
  }
}

static int compare_die_names(const void *left, const void *right) {
  const fg_index_die *a = left, *b = right;
  return strcmp(a->name, b->name);
}

/* Sorts the dies by name, and renumbers them in the foils. */
static fg_status order_dies(fg_context *ctx, fg_index *index) {
  size_t *place = NULL;
  FG_TRY(fg_memory_allocate(ctx, index->die_count, sizeof *place, (void **)&place));
  for (size_t i = 0; i < index->die_count; i++)
    index->dies[i].foils = i; /* place before sorting; foils are not counted yet */
  fg_sort_items(index->dies, index->die_count, sizeof *index->dies, compare_die_names);
  for (size_t i = 0; i < index->die_count; i++) {
    place[index->dies[i].foils] = i;
    index->dies[i].foils = 0;
  }
  for (size_t i = 0; i < index->read; i++)
    for (size_t k = 0; k < index->lots[i].foil_count; k++)
      if (index->lots[i].die[k] != FG_INDEX_NONE)
        index->lots[i].die[k] = place[index->lots[i].die[k]];
  free(place);
  return FG_OK;
}

static bool has_axis(const fg_index *index, const fg_quantity *row) {
  for (size_t i = 0; i < index->axis_count; i++)
    if (index->axes[i].row == row) return true;
  return false;
}

static bool is_dimension(const fg_quantity *row) {
  return !strcmp(row->unit, "mm") || !strcmp(row->unit, "°");
}

static fg_index_scale choose_scale(const fg_index *index, const fg_quantity *row) {
  if (index->designs < 2 || !is_dimension(row)) return FG_INDEX_AS_IS;
  return row->nominal ? FG_INDEX_OVER_DESIGN : FG_INDEX_APART;
}

/* Lists the axes: quantities of bumps and beams before those of foils, each in the order of the
 * lots' reports. */
static fg_status list_index_axes(fg_context *ctx, fg_index *index) {
  static const fg_quantity_owner owners[] = {FG_QUANTITY_OF_BUMP, FG_QUANTITY_OF_BEAM,
                                             FG_QUANTITY_OF_FOIL};
  size_t capacity = 0;
  for (size_t o = 0; o < sizeof owners / sizeof *owners; o++)
    for (size_t i = 0; i < index->read; i++)
      for (size_t k = 0; k < index->lots[i].stat_count; k++) {
        const fg_index_stat *stat = &index->lots[i].stats[k];
        if (stat->owner != owners[o] || !stat->count || has_axis(index, stat->row)) continue;
        FG_TRY(fg_memory_reserve(ctx, index->axis_count + 1, sizeof *index->axes, &capacity,
                                 (void **)&index->axes));
        index->axes[index->axis_count++] = (fg_index_axis){.row = stat->row,
                                                           .owner = stat->owner,
                                                           .scale = choose_scale(index, stat->row),
                                                           .same_as = FG_INDEX_NONE,
                                                           .p_equal = NAN,
                                                           .within_sd = NAN};
      }
  return FG_OK;
}

fg_index_stat *fg_index_stat_of(const fg_index_axis *axis, const fg_index_lot *lot) {
  for (size_t i = 0; i < lot->stat_count; i++)
    if (lot->stats[i].row == axis->row) return &lot->stats[i];
  return NULL;
}

const char *fg_index_unit(const fg_index_axis *axis) {
  return axis->scale == FG_INDEX_OVER_DESIGN ? "" : axis->row->unit;
}

static void scale_stat(fg_index_lot *lot, fg_index_stat *stat, fg_index_scale scale) {
  double by =
      scale == FG_INDEX_OVER_DESIGN ? 1 / stat->row->nominal(&lot->design, &lot->nominal) : 1;
  double *values[] = {&stat->mean, &stat->sd,  &stat->median, &stat->mode,
                      &stat->min,  &stat->max, &stat->lower,  &stat->upper};
  double sum = 0, squares = 0, first = NAN; /* equal values have a mean that is theirs to the bit */
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    *values[i] *= by;
  for (size_t i = 0; i < lot->foil_count; i++) {
    stat->foil[i] *= by;
    if (!isfinite(stat->foil[i])) continue;
    if (!stat->foils++) first = stat->foil[i];
    sum += stat->foil[i] - first;
  }
  stat->foil_mean = first + sum / (double)stat->foils;
  for (size_t i = 0; i < lot->foil_count; i++)
    if (isfinite(stat->foil[i]))
      squares += (stat->foil[i] - stat->foil_mean) * (stat->foil[i] - stat->foil_mean);
  stat->foil_sd = stat->foils > 1 ? sqrt(squares / (double)(stat->foils - 1)) : NAN;
  if (!stat->foils) stat->foil_mean = NAN;
}

static void scale_axis(fg_index *index, fg_index_axis *axis) {
  for (size_t i = 0; i < index->read; i++) {
    fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat) continue;
    scale_stat(&index->lots[i], stat, axis->scale);
    axis->limited = axis->limited || isfinite(stat->lower) || isfinite(stat->upper);
  }
}

/* Sums over all foils that have both values. */
typedef struct line {
  double n, x, y, xx, yy, xy;
  double x0, y0; /* origin, subtracted to keep digits */
  bool apart;    /* a foil has only one of the values */
} line;

static void add_lot_to_line(line *l, const fg_index_stat *a, const fg_index_stat *b, size_t foils) {
  for (size_t i = 0; i < foils; i++) {
    bool first = isfinite(a->foil[i]), second = isfinite(b->foil[i]);
    l->apart = l->apart || first != second;
    if (!first || !second) continue;
    if (l->n == 0) {
      l->x0 = a->foil[i];
      l->y0 = b->foil[i];
    }
    double x = a->foil[i] - l->x0, y = b->foil[i] - l->y0;
    l->n++;
    l->x += x;
    l->y += y;
    l->xx += x * x;
    l->yy += y * y;
    l->xy += x * y;
  }
}

static bool is_same_on_line(const fg_index *index, const fg_index_axis *a, const fg_index_axis *b) {
  line l = {0};
  if (a->owner != b->owner) return false;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_lot *lot = &index->lots[i];
    const fg_index_stat *x = fg_index_stat_of(a, lot), *y = fg_index_stat_of(b, lot);
    if (!x != !y) return false;
    if (x && lot->foil_count) add_lot_to_line(&l, x, y, lot->foil_count);
  }
  double xx = l.xx - l.x * l.x / l.n, yy = l.yy - l.y * l.y / l.n, xy = l.xy - l.x * l.y / l.n;
  return !l.apart && l.n > 2 && xx > 0 && yy > 0 && 1 - xy * xy / (xx * yy) < ON_ONE_LINE;
}

static void find_same(fg_index *index) {
  for (size_t b = 0; b < index->axis_count; b++)
    for (size_t a = 0; a < b && index->axes[b].same_as == FG_INDEX_NONE; a++)
      if (index->axes[a].same_as == FG_INDEX_NONE && index->axes[a].scale != FG_INDEX_APART &&
          index->axes[b].scale != FG_INDEX_APART &&
          is_same_on_line(index, &index->axes[a], &index->axes[b]))
        index->axes[b].same_as = a;
}

fg_status fg_index_arrange(fg_context *ctx, fg_index *index) {
  fg_sort_items(index->lots, index->count, sizeof *index->lots, compare_dates);
  index->read = 0;
  while (index->read < index->count && !index->lots[index->read].problem)
    index->read++;
  number_designs(index);
  if (index->die_count) FG_TRY(order_dies(ctx, index));
  FG_TRY(list_index_axes(ctx, index));
  for (size_t i = 0; i < index->axis_count; i++)
    scale_axis(index, &index->axes[i]);
  find_same(index);
  return FG_OK;
}

static void free_lot(fg_index_lot *lot) {
  for (size_t i = 0; i < lot->stat_count; i++)
    free(lot->stats[i].foil);
  free(lot->stats);
  free(lot->name);
  free(lot->problem);
  free(lot->foils_unknown);
  free(lot->scan_sum);
  free(lot->die);
  free(lot->die_names);
  free(lot->coils);
  free(lot->ratio);
  free(lot->ratio_foil);
  fg_density_free(&lot->spread.density);
}

void fg_index_free(fg_index *index) {
  for (size_t i = 0; i < index->count; i++)
    free_lot(&index->lots[i]);
  for (size_t i = 0; i < index->die_count; i++) {
    free(index->dies[i].name);
    fg_density_free(&index->dies[i].spread.density);
  }
  for (size_t i = 0; i < index->sentence_count; i++)
    free(index->sentences[i]);
  free(index->sentences);
  free(index->lots);
  free(index->dies);
  free(index->axes);
  free(index->pairs);
  free(index->die_pairs);
  free(index->notes);
  *index = (fg_index){0};
}
