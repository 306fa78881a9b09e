/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots as sets: means of ln(formed / die) by place, and the scatter about them. */
#include "compensation/sets.h"
#include "compensation/springback.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "lot/run/date.h"
#include "lot/statistics/analysis.h"

enum { LOT_TEXT_BYTES = 1 << 30 };

typedef enum lot_text { RESULTS_TEXT, MANIFEST_TEXT, RECIPE_TEXT, LOT_TEXTS } lot_text;

static fg_status read_lot_texts(fg_context *ctx, const char *folder, char *text[LOT_TEXTS]) {
  static const char *const names[LOT_TEXTS] = {"results.jsonl", "manifest.csv", "recipe.json"};
  for (int i = 0; i < LOT_TEXTS; i++) {
    char *path;
    FG_TRY(fg_lot_path(ctx, folder, names[i], &path));
    fg_status status = fg_file_read_text(ctx, path, LOT_TEXT_BYTES, &text[i]);
    free(path);
    FG_TRY(status);
  }
  return FG_OK;
}

/* Sums the scans: a copy of the lot under another name has the same. */
static fg_status sum_scans(fg_context *ctx, fg_formed_lot *lot) {
  char *sums = NULL;
  fg_status status = FG_OK;
  for (size_t i = 0; i < lot->lot.manifest.items && status == FG_OK; i++)
    status = fg_text_append(ctx, &sums, "%s\n", lot->lot.records[i].sha256);
  if (status == FG_OK) fg_sha256_text(sums ? sums : "", lot->scans_sha256);
  free(sums);
  return status;
}

fg_status fg_formed_lot_read(fg_context *ctx, const char *folder, fg_formed_lot *lot) {
  char *text[LOT_TEXTS] = {NULL};
  fg_lot_date date;
  fg_status status = FG_OK;
  *lot = (fg_formed_lot){.folder = ""};
  fg_text_clip(lot->folder, sizeof lot->folder, "%s", folder);
  FG_TRY_EXIT(read_lot_texts(ctx, folder, text));
  fg_sha256_text(text[RESULTS_TEXT], lot->sha256);
  fg_lot_settings_default(&lot->lot.settings);
  FG_TRY_EXIT(fg_lot_settings_parse(ctx, folder, text[RECIPE_TEXT], &lot->lot.settings));
  FG_TRY_EXIT(fg_manifest_parse(ctx, folder, text[MANIFEST_TEXT], "", &lot->lot.manifest));
  FG_TRY_EXIT(fg_lot_load(ctx, folder, &lot->lot));
  FG_TRY_EXIT(sum_scans(ctx, lot));
  fg_lot_date_find(&lot->lot, &date);
  fg_text_clip(lot->date, sizeof lot->date, "%s", date.first);
exit:
  for (int i = 0; i < LOT_TEXTS; i++)
    free(text[i]);
  if (status != FG_OK) fg_formed_lot_free(lot);
  return status;
}

void fg_formed_lot_free(fg_formed_lot *lot) {
  fg_lot_free(&lot->lot);
  lot->lot = (fg_lot){.records = NULL};
}

static double log_ratio_of(double formed, double die) {
  return formed > 0 && die > 0 ? log(formed / die) : NAN;
}

/* Angle from bump to bump: the turn from the first to the last, over their numbers. */
static double foil_pitch(const fg_foil *foil) {
  const fg_bump *ends[2] = {NULL, NULL};
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    if (!fg_lot_bump_counts(foil, bump) || !isfinite(bump->centre_mm.x)) continue;
    if (!ends[0]) ends[0] = bump;
    ends[1] = bump;
  }
  if (!ends[0] || ends[0] == ends[1]) return NAN;
  fg_point o = foil->overall.centre_mm;
  double turn = 0, before = NAN;
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    double angle = atan2(bump->centre_mm.y - o.y, bump->centre_mm.x - o.x);
    if (bump->number < ends[0]->number || bump->number > ends[1]->number || !isfinite(angle))
      continue;
    if (isfinite(before)) turn += remainder(angle - before, 2 * M_PI);
    before = angle;
  }
  return fabs(turn) * 180 / M_PI / (ends[1]->number - ends[0]->number);
}

/* Fills what a foil says of the die's quantities; false: nothing at all. */
static bool fill_formed_foil(const fg_foil *foil, const fg_die_dimensions *die, size_t bumps,
                             fg_formed_foil *formed) {
  bool any = false;
  if (!fg_foil_is_measured(foil)) return false;
  for (size_t i = 0; i < FG_COMPENSATION_BUMPS; i++)
    formed->log_ratio[0][i] = formed->log_ratio[1][i] = formed->height_mm[i] = NAN;
  formed->overall = log_ratio_of(foil->overall.radius_mm, die->overall_radius_mm);
  formed->pitch = bumps ? log_ratio_of(foil_pitch(foil), die->pitch_deg) : NAN;
  for (size_t k = 0; k < foil->bump_count; k++) {
    const fg_bump *bump = &foil->bumps[k];
    size_t i = (size_t)bump->number - 1;
    if (bump->number < 1 || i >= bumps || !fg_lot_bump_counts(foil, bump)) continue;
    const fg_die_bump_dimensions *of = &die->bump[i];
    formed->log_ratio[FG_FORMED_RADIUS][i] = log_ratio_of(bump->radius_mm, of->radius_mm);
    formed->log_ratio[FG_FORMED_ARC_LENGTH][i] =
        log_ratio_of(bump->radius_mm * bump->bump_angle_deg, of->radius_mm * of->bump_angle_deg);
    formed->height_mm[i] = bump->height_mm;
    any = any || isfinite(formed->log_ratio[FG_FORMED_RADIUS][i]);
  }
  return any || isfinite(formed->overall);
}

static fg_status append_formed_foil(fg_context *ctx, fg_formed_sets *sets,
                                    const fg_formed_foil *foil) {
  size_t capacity = sets->foil_capacity;
  FG_TRY(fg_memory_reserve(ctx, sets->foils + 1, sizeof *sets->foil, &sets->foil_capacity,
                           (void **)&sets->foil));
  FG_TRY(fg_memory_reserve(ctx, sets->foils + 1, sizeof *sets->foil_set, &capacity,
                           (void **)&sets->foil_set));
  sets->foil[sets->foils] = *foil;
  sets->foil_set[sets->foils++] = sets->count;
  return FG_OK;
}

static double value_at(const fg_formed_foil *foil, fg_formed formed, size_t place) {
  if (formed == FG_FORMED_OVERALL) return foil->overall;
  return formed == FG_FORMED_PITCH ? foil->pitch : foil->log_ratio[formed][place];
}

static double die_value(const fg_die_dimensions *die, fg_formed formed, size_t place) {
  if (formed == FG_FORMED_OVERALL) return die->overall_radius_mm;
  if (formed == FG_FORMED_PITCH) return die->pitch_deg;
  const fg_die_bump_dimensions *bump = &die->bump[place];
  return formed == FG_FORMED_RADIUS ? bump->radius_mm
                                    : bump->radius_mm * bump->bump_angle_deg / 180 * M_PI;
}

/* Sums of squares of the foils' levels about the places' means, and of the remainder. */
static void add_foil_squares(const fg_formed_foil *foil, fg_formed formed, size_t places,
                             const double *mean, fg_formed_data *data) {
  double sum = 0, squares = 0, count = 0;
  for (size_t i = 0; i < places; i++) {
    double step = value_at(foil, formed, i) - mean[i];
    if (!isfinite(step)) continue;
    sum += step;
    squares += step * step;
    count++;
  }
  if (!(count > 0)) return;
  data->level_squares += sum * sum / count;
  data->level_dof++;
  data->rest_squares += fmax(squares - sum * sum / count, 0);
  data->rest_dof += count - 1;
}

static void summarise_set(const fg_formed_foil *foil, size_t foils, const fg_die_dimensions *die,
                          size_t bumps, fg_formed formed, fg_formed_data *data) {
  double mean[FG_COMPENSATION_BUMPS] = {0};
  size_t places = fg_formed_is_by_bump(formed) ? bumps : 1;
  for (size_t i = 0; i < places; i++) {
    double count = 0;
    for (size_t f = 0; f < foils; f++) {
      double value = value_at(&foil[f], formed, i);
      if (isfinite(value)) mean[i] += (value - mean[i]) / ++count;
    }
    if (!(count > 0)) continue;
    data->place[data->places++] =
        (fg_formed_place){.number = fg_formed_is_by_bump(formed) ? (int)i + 1 : 0,
                          .foils = count,
                          .die = die_value(die, formed, i),
                          .log_ratio = mean[i]};
  }
  for (size_t f = 0; f < foils; f++)
    add_foil_squares(&foil[f], formed, places, mean, data);
  /* The places' means take as many degrees of freedom: one of the levels, the others of the rest.
   */
  data->level_dof = fmax(0, data->level_dof - 1);
  data->rest_dof = fmax(0, data->rest_dof - ((double)data->places - 1));
}

/* Scans of a foil (column `foil`) as they are added. */
typedef struct formed_scan {
  const char *part; /* "": not named */
  const char *bearing;
  int number;           /* in its scan */
  fg_formed_foil count; /* of the scans so far that show each value */
} formed_scan;

static const char *cell_or_empty(const fg_manifest *manifest, size_t item, const char *column) {
  size_t at = fg_manifest_column(manifest, column);
  return at == FG_NO_COLUMN ? "" : fg_manifest_cell(manifest, item, at);
}

static formed_scan name_formed_scan(const fg_formed_lot *lot, size_t item, size_t foil) {
  const fg_manifest *manifest = &lot->lot.manifest;
  const fg_lot_settings *settings = &lot->lot.settings;
  return (formed_scan){.part = cell_or_empty(manifest, item, settings->part_column),
                       .bearing = cell_or_empty(manifest, item, settings->bearing_column),
                       .number = lot->lot.records[item].foils[foil].number};
}

/* Adds a value, if it is known, to the mean of `count` of them. */
static void average(double *mean, double *count, double value) {
  if (!isfinite(value)) return;
  *mean = *count > 0 ? *mean + (value - *mean) / (*count + 1) : value;
  ++*count;
}

/* Adds a scan of a foil to the mean of its scans. A bump that one of them lacks counts as the
 * others show it. */
static void average_scans(fg_formed_foil *mean, fg_formed_foil *count, const fg_formed_foil *scan) {
  average(&mean->overall, &count->overall, scan->overall);
  average(&mean->pitch, &count->pitch, scan->pitch);
  for (size_t i = 0; i < FG_COMPENSATION_BUMPS; i++) {
    average(&mean->height_mm[i], &count->height_mm[i], scan->height_mm[i]);
    for (int k = 0; k < 2; k++)
      average(&mean->log_ratio[k][i], &count->log_ratio[k][i], scan->log_ratio[k][i]);
  }
}

/* Adds a foil, or to the mean of its scans where an earlier one shows it. `scan` has room for every
 * foil of the set. */
static fg_status add_formed_scan(fg_context *ctx, const fg_formed_foil *formed, formed_scan named,
                                 size_t first, formed_scan *scan, fg_formed_sets *sets) {
  /* Scans of a foil follow each other in most lots. */
  for (size_t k = *named.part ? sets->foils - first : 0; k-- > 0;)
    if (scan[k].number == named.number && !strcmp(scan[k].part, named.part) &&
        !strcmp(scan[k].bearing, named.bearing)) {
      average_scans(&sets->foil[first + k], &scan[k].count, formed);
      return FG_OK;
    }
  fg_formed_foil mean = *formed;
  average_scans(&mean, &named.count, formed);
  scan[sets->foils - first] = named;
  return append_formed_foil(ctx, sets, &mean);
}

static fg_status add_formed_foils(fg_context *ctx, const fg_formed_lot *lot, const char *name,
                                  const fg_die_dimensions *die, size_t bumps,
                                  fg_formed_sets *sets) {
  const fg_manifest *manifest = &lot->lot.manifest;
  size_t first = sets->foils, column = fg_manifest_column(manifest, lot->lot.settings.die_column);
  size_t count = 0;
  formed_scan *scan;
  fg_formed_foil formed;
  fg_status status = FG_OK;
  for (size_t i = 0; i < manifest->items; i++)
    count += lot->lot.records[i].foil_count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *scan, (void **)&scan));
  for (size_t i = 0; i < manifest->items; i++)
    for (size_t f = 0; f < lot->lot.records[i].foil_count; f++) {
      bool of_die = !name || !strcmp(fg_manifest_cell(manifest, i, column), name);
      if (of_die && fill_formed_foil(&lot->lot.records[i].foils[f], die, bumps, &formed))
        FG_TRY_EXIT(add_formed_scan(ctx, &formed, name_formed_scan(lot, i, f), first, scan, sets));
    }
exit:
  free(scan);
  return status;
}

/* The die of a set; its name as the manifest has it, NULL: all foils of the lot are of it. */
typedef struct set_die {
  const char *name;
  const fg_die_dimensions *dimensions;
  fg_die_origin origin;
} set_die;

/* Adds the foils of one die, and their set where there are any. */
static fg_status add_set(fg_context *ctx, const fg_formed_lot *lot, const set_die *die,
                         size_t bumps, fg_formed_sets *sets) {
  size_t first = sets->foils;
  FG_TRY(add_formed_foils(ctx, lot, die->name, die->dimensions, bumps, sets));
  if (sets->foils == first) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, sets->count + 1, sizeof *sets->set, &sets->capacity,
                           (void **)&sets->set));
  fg_formed_set *set = &sets->set[sets->count++];
  *set = (fg_formed_set){.origin = die->origin, .foils = sets->foils - first};
  fg_text_clip(set->lot, sizeof set->lot, "%s",
               lot->lot.settings.name[0] ? lot->lot.settings.name : lot->folder);
  fg_text_clip(set->die, sizeof set->die, "%s", die->name ? die->name : "");
  fg_text_clip(set->folder, sizeof set->folder, "%s", lot->folder);
  fg_text_clip(set->date, sizeof set->date, "%s", lot->date);
  memcpy(set->sha256, lot->sha256, sizeof set->sha256);
  memcpy(set->scans_sha256, lot->scans_sha256, sizeof set->scans_sha256);
  for (int q = 0; q < FG_FORMED; q++)
    summarise_set(sets->foil + first, set->foils, die->dimensions, bumps, (fg_formed)q,
                  &set->of[q]);
  return FG_OK;
}

/* Puts the radii that the recipe has of a die in place of the design's. */
static void use_recipe_die(const fg_lot_die *kept, fg_die_dimensions *die) {
  for (size_t i = 0; i < die->bumps; i++) {
    die->bump[i].radius_mm = kept->radius_mm;
    die->bump[i].u_radius_mm = kept->u_radius_mm;
    for (size_t k = 0; k < kept->bump_count; k++)
      if (kept->bump[k].number == die->bump[i].number)
        die->bump[i].radius_mm = kept->bump[k].radius_mm;
  }
}

/* True for a name that an earlier row of the manifest has. */
static bool is_named_before(const fg_manifest *manifest, size_t column, size_t item) {
  for (size_t i = 0; i < item; i++)
    if (!strcmp(fg_manifest_cell(manifest, i, column), fg_manifest_cell(manifest, item, column)))
      return true;
  return false;
}

/* A lot that has taught a law neither teaches it again nor tests it. */
static fg_status check_new_lot(fg_context *ctx, const fg_formed_lot *lot,
                               const fg_formed_sets *sets) {
  for (size_t i = 0; i < sets->count; i++)
    if (!strcmp(sets->set[i].scans_sha256, lot->scans_sha256))
      return fg_fail(ctx, FG_ERR_DATA, "%s: the same scans as lot %s, which counts already",
                     lot->folder, sets->set[i].lot);
  return FG_OK;
}

fg_status fg_formed_sets_add(fg_context *ctx, const fg_formed_lot *lot,
                             const fg_die_dimensions *die, fg_die_origin origin, size_t bumps,
                             fg_formed_sets *sets) {
  const fg_manifest *manifest = &lot->lot.manifest;
  size_t column = fg_manifest_column(manifest, lot->lot.settings.die_column), before = sets->count;
  FG_TRY(check_new_lot(ctx, lot, sets));
  if (origin != FG_DIE_AS_DESIGNED || column == FG_NO_COLUMN)
    FG_TRY(add_set(ctx, lot, &(set_die){NULL, die, origin}, bumps, sets));
  else
    for (size_t i = 0; i < manifest->items; i++) {
      const char *name = fg_manifest_cell(manifest, i, column);
      const fg_lot_die *kept = fg_lot_dies_find(&lot->lot.settings, name);
      fg_die_dimensions own = *die;
      if (is_named_before(manifest, column, i)) continue;
      if (kept) use_recipe_die(kept, &own);
      const set_die named = {name, &own, kept ? FG_DIE_AS_MEASURED : FG_DIE_AS_DESIGNED};
      FG_TRY(add_set(ctx, lot, &named, bumps, sets));
    }
  if (sets->count > before) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: not one measured foil, so nothing is known of its springback", lot->folder);
}

void fg_formed_sets_free(fg_formed_sets *sets) {
  free(sets->set);
  free(sets->foil);
  free(sets->foil_set);
  *sets = (fg_formed_sets){.count = 0};
}
