/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/inputs.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/member_read.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/words.h"

enum { PRIOR_BYTES = 64 << 20 };

void fg_next_die_note(fg_next_die *next, const char *format, ...) {
  va_list values;
  if (next->notes == FG_COMPENSATION_NOTES) return;
  va_start(values, format);
  vsnprintf(next->note[next->notes++], sizeof *next->note, format, values);
  va_end(values);
}

static bool is_prior_schema(const cJSON *root) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  const char *name = cJSON_IsString(schema) ? schema->valuestring : "";
  return !strcmp(name, "foilgauge/next_die/1") || !strcmp(name, "foilgauge/expected/1");
}

static fg_status read_kept_law(fg_context *ctx, const cJSON *root, fg_springback_law *law) {
  const fg_reading reading = {.ctx = ctx, .between = ": ", .has_others = true};
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "law");
  if (!is_prior_schema(root) || !cJSON_IsObject(item))
    return fg_fail(ctx, FG_ERR_DATA,
                   "neither a report of `foilgauge die --target -o` nor the "
                   "expected.json of a lot");
  FG_TRY(fg_object_read(&reading, &fg_law_members, item, law));
  return law->sets ? FG_OK : fg_fail(ctx, FG_ERR_DATA, "the member law.sets is missing or empty");
}

/* Copies the sets to the head of the list. */
static fg_status read_prior_sets(fg_context *ctx, const cJSON *root, fg_formed_sets *sets) {
  fg_springback_law *law;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *law, (void **)&law));
  fg_status status = read_kept_law(ctx, root, law);
  if (status == FG_OK)
    status =
        fg_memory_reserve(ctx, law->sets, sizeof *sets->set, &sets->capacity, (void **)&sets->set);
  if (status == FG_OK) {
    memcpy(sets->set, law->set, law->sets * sizeof *sets->set);
    sets->count = law->sets;
  }
  free(law);
  return status;
}

fg_status fg_prior_read(fg_context *ctx, const char *path, fg_formed_sets *sets) {
  char *text = NULL;
  cJSON *root;
  fg_context inner = {.message = ""};
  FG_TRY(fg_file_read_text(ctx, path, PRIOR_BYTES, &text));
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  status = read_prior_sets(&inner, root, sets);
  cJSON_Delete(root);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s: %.*s", path, 700, inner.message);
}

/* A lot and a target are of one kind, strip and datum; a lot of other bumps says nothing. */
fg_status fg_compensation_check_lot(fg_context *ctx, const char *folder, const fg_design *lot,
                                    const fg_design *target) {
  if (fg_foil_traits_of(lot->kind)->has_bumps != fg_foil_traits_of(target->kind)->has_bumps)
    return fg_fail(ctx, FG_ERR_DATA, "%s: its foils are of form %s, the target's of form %s",
                   folder, fg_foil_kind_word(lot->kind), fg_foil_kind_word(target->kind));
  if (lot->datum != target->datum)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "%s: measured for datum %s, the target has %s: measure the lot with the target's design",
        folder, fg_datum_word(lot->datum), fg_datum_word(target->datum));
  if (fabs(lot->thickness_mm - target->thickness_mm) > 1e-9)
    return fg_fail(ctx, FG_ERR_DATA, "%s: its strip has %g mm, the target's %g mm", folder,
                   lot->thickness_mm, target->thickness_mm);
  return FG_OK;
}

static fg_status check_target(fg_context *ctx, const char *path, const fg_design *target) {
  bool strip = fg_foil_traits_of(target->kind)->is_plain_strip;
  if (fg_foil_traits_of(target->kind)->has_bumps || strip) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: form \"%s\" is bent by no die", path,
                 fg_foil_kind_word(target->kind));
}

static size_t highest_number(const fg_lot *lot) {
  int highest = 0;
  for (size_t i = 0; i < lot->manifest.items; i++)
    for (size_t f = 0; f < lot->records[i].foil_count; f++) {
      const fg_foil *foil = &lot->records[i].foils[f];
      for (size_t k = 0; k < foil->bump_count; k++)
        if (foil->bumps[k].number > highest) highest = foil->bumps[k].number;
    }
  return (size_t)highest;
}

/* Reads the die of a lot: its report, else that of the earlier report, else the lot's design. */
static fg_status find_lot_die(fg_context *ctx, const fg_compensation_lot *from,
                              const fg_formed_lot *lot, const fg_compensation_inputs *inputs,
                              fg_die_dimensions *die, fg_die_origin *origin) {
  const fg_design *design = &lot->lot.settings.design;
  if (from->die) return fg_die_dimensions_load(ctx, from->die, design, inputs->bumps, die, origin);
  *origin = FG_DIE_AS_DESIGNED;
  if (!inputs->has_prior) return fg_die_dimensions_of_design(ctx, design, inputs->bumps, die);
  *die = inputs->present;
  *origin = FG_DIE_AS_CUT;
  return FG_OK;
}

static void note_bumps(const fg_formed_lot *lot, fg_next_die *next, size_t bumps) {
  size_t seen = highest_number(&lot->lot);
  if (bumps && seen != bumps)
    fg_next_die_note(next, "%s has %zu bumps, the target %zu: %s", lot->folder, seen, bumps,
                     seen < bumps ? "of the others the law knows what all have in common"
                                  : "the others are left out");
}

static fg_status add_lot(fg_context *ctx, const fg_compensation_request *request, size_t i,
                         fg_next_die *next, fg_compensation_inputs *inputs) {
  fg_formed_lot lot;
  fg_die_dimensions die;
  fg_die_origin origin;
  FG_TRY(fg_formed_lot_read(ctx, request->lots[i].folder, &lot));
  fg_status status = FG_OK;
  const fg_design *design = &lot.lot.settings.design;
  if (!request->target && i == 0) next->target = *design;
  FG_TRY_EXIT(fg_compensation_check_lot(ctx, lot.folder, design, &next->target));
  if (!inputs->bumps && fg_foil_traits_of(next->target.kind)->has_bumps)
    inputs->bumps = highest_number(&lot.lot);
  note_bumps(&lot, next, inputs->bumps);
  FG_TRY_EXIT(find_lot_die(ctx, &request->lots[i], &lot, inputs, &die, &origin));
  FG_TRY_EXIT(fg_formed_sets_add(ctx, &lot, &die, origin, inputs->bumps, &inputs->sets));
  if (origin == FG_DIE_AS_DESIGNED && inputs->sets.set[inputs->sets.count - 1].origin == origin)
    fg_next_die_note(next,
                     "%s: no report of its die: taken as its design says; measure it with "
                     "`foilgauge die` and name it with --die",
                     lot.folder);
  inputs->present = die;
exit:
  fg_formed_lot_free(&lot);
  return status;
}

static fg_status load_target(fg_context *ctx, const fg_compensation_request *request,
                             fg_next_die *next) {
  fg_design_default(&next->target);
  if (!request->target) return FG_OK;
  FG_TRY(fg_design_load(ctx, request->target, &next->target));
  fg_text_clip(next->target_path, sizeof next->target_path, "%s", request->target);
  FG_TRY(fg_sha256_file(ctx, request->target, next->target_sha256));
  return check_target(ctx, request->target, &next->target);
}

/* Bumps that the earlier sets have, where the target does not say. */
static size_t highest_place(const fg_formed_sets *sets) {
  int highest = 0;
  for (size_t i = 0; i < sets->count; i++)
    for (size_t k = 0; k < sets->set[i].of[FG_FORMED_RADIUS].places; k++)
      if (sets->set[i].of[FG_FORMED_RADIUS].place[k].number > highest)
        highest = sets->set[i].of[FG_FORMED_RADIUS].place[k].number;
  return (size_t)highest;
}

static fg_status read_prior(fg_context *ctx, const char *path, const fg_next_die *next,
                            fg_compensation_inputs *inputs) {
  fg_die_origin origin;
  FG_TRY(fg_prior_read(ctx, path, &inputs->sets));
  if (!inputs->bumps && fg_foil_traits_of(next->target.kind)->has_bumps)
    inputs->bumps = highest_place(&inputs->sets);
  return fg_die_dimensions_load(ctx, path, &next->target, inputs->bumps, &inputs->present, &origin);
}

fg_status fg_compensation_inputs_read(fg_context *ctx, const fg_compensation_request *request,
                                      fg_next_die *next, fg_compensation_inputs *inputs) {
  if (!request->lot_count && !request->prior)
    return fg_fail(ctx, FG_ERR_USAGE, "a die is found from lots: name one with --lot");
  FG_TRY(load_target(ctx, request, next));
  if (fg_foil_traits_of(next->target.kind)->has_bumps) inputs->bumps = next->target.bumps.count;
  inputs->has_prior = request->prior != NULL;
  if (request->prior) FG_TRY(read_prior(ctx, request->prior, next, inputs));
  for (size_t i = 0; i < request->lot_count; i++)
    FG_TRY(add_lot(ctx, request, i, next, inputs));
  if (inputs->sets.count > FG_COMPENSATION_SETS)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%zu sets of foils from one die each: %d at most; leave out "
                   "the oldest",
                   inputs->sets.count, FG_COMPENSATION_SETS);
  if (inputs->bumps > FG_COMPENSATION_BUMPS)
    return fg_fail(ctx, FG_ERR_DATA, "%zu bumps: a die is found for %d at most", inputs->bumps,
                   FG_COMPENSATION_BUMPS);
  next->nominal = (fg_nominal){.height_mm = NAN};
  return fg_design_derive(ctx, &next->target, &next->nominal);
}
