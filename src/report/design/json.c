/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a design: its members by their rows, then checks that one member alone does not show. */
#include "report/design/json.h"

#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"
#include "report/design/kind_members.h"
#include "report/design/members.h"

enum { DESIGN_BYTES_MAX = 1 << 20, MESSAGE_MAX = 900 };

/* A design while it is read: dimensions of every group, as `form` may come last. */
typedef struct stated_design {
  fg_design design;
  fg_design groups[FG_DESIGN_GROUPS];
} stated_design;

static void *find_dimensions(const fg_member *member, void *object) {
  static bool (*const is_of[FG_DESIGN_GROUPS])(const fg_subject *) = {
      [FG_DESIGN_BUMPS] = fg_design_is_of_bumps, [FG_DESIGN_BEAMS] = fg_design_is_of_beams,
      [FG_DESIGN_DISCS] = fg_design_is_of_discs, [FG_DESIGN_ARC] = fg_design_is_of_arc,
      [FG_DESIGN_GRID] = fg_design_is_of_grid,
  };
  for (int group = 0; group < FG_DESIGN_GROUPS; group++)
    if (member->present && member->present == is_of[group])
      return &((stated_design *)object)->groups[group];
  return object;
}

/* A file that states one of these and leaves another to the default would be measured against a
 * mixture of two designs. */
static fg_status check_complete(const fg_reading *reading, const cJSON *root,
                                const fg_design *design) {
  static const char *const together[] = {"bump_radius_mm", "bump_angle_deg", "overall_radius_mm",
                                         "thickness_mm"};
  const char *given = NULL, *missing = NULL;
  for (size_t i = 0; i < sizeof together / sizeof *together; i++) {
    bool has = cJSON_GetObjectItemCaseSensitive(root, together[i]) != NULL;
    if (has && !given) given = together[i];
    if (!has && !missing) missing = together[i];
  }
  if (!fg_foil_kind_has_bumps(design->kind) || !given || !missing) return FG_OK;
  return fg_reading_fail(reading, missing, "is missing; a design that states %s must state it too",
                         given);
}

static bool has_member(const cJSON *root, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(root, name) != NULL;
}

/* A kind without defaults: members that it needs, and those of other kinds, which would be ignored.
 */
static fg_status check_kind_members(const fg_reading *reading, const cJSON *root,
                                    const fg_foil_traits *kind) {
  for (size_t i = 0; kind->needed[i]; i++)
    if (!has_member(root, kind->needed[i]))
      return fg_reading_fail(reading, kind->needed[i], "is missing; %s must state it", kind->noun);
  for (size_t i = 0; kind->foreign[i]; i++)
    if (has_member(root, kind->foreign[i]))
      return fg_reading_fail(reading, kind->foreign[i],
                             "belongs to a foil with bumps; form is \"%s\"", kind->name);
  return FG_OK;
}

static fg_status check_members(const fg_reading *reading, const cJSON *root,
                               stated_design *stated) {
  fg_design *design = &stated->design;
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  if (kind->needed[0]) {
    FG_TRY(check_kind_members(reading, root, kind));
    if (!has_member(root, "name"))
      fg_text_clip(design->name, sizeof design->name, "%s", kind->name);
    return FG_OK;
  }
  FG_TRY(check_complete(reading, root, design));
  if (has_member(root, "overall_radius_mm") && !has_member(root, "sleeve_radius_mm"))
    stated->groups[FG_DESIGN_BUMPS].bumps.sleeve_radius_mm = design->overall_radius_mm;
  return FG_OK;
}

static fg_status read_design(const fg_reading *reading, const cJSON *root, stated_design *stated) {
  FG_TRY(fg_object_read(reading, &fg_design_members, root, stated));
  FG_TRY(check_members(reading, root, stated));
  stated->design.values = stated->groups[fg_foil_traits_of(stated->design.kind)->group].values;
  return FG_OK;
}

static fg_status check_design(const fg_reading *reading, const stated_design *stated) {
  const fg_design *design = &stated->design;
  fg_context words = {0};
  fg_status status = fg_design_check_common(&words, design);
  for (int group = 0; group < FG_DESIGN_GROUPS && status == FG_OK; group++)
    status = fg_design_check_refused(&words, design->kind, (fg_design_group)group,
                                     &stated->groups[group].values);
  if (status == FG_OK) status = fg_design_check(&words, design);
  if (status == FG_OK) status = fg_report_check_tolerances(&words, design);
  if (status == FG_OK) return FG_OK;
  return fg_fail(reading->ctx, status, "%s: %.*s", reading->path, MESSAGE_MAX, words.message);
}

fg_status fg_design_parse(fg_context *ctx, const char *path, const char *json, fg_design *design) {
  const fg_reading reading = {
      .ctx = ctx, .path = path, .between = ": ", .object_of = find_dimensions};
  stated_design stated = {.design = *design};
  cJSON *root;
  for (int group = 0; group < FG_DESIGN_GROUPS; group++)
    fg_design_group_default((fg_design_group)group, &stated.groups[group].values);
  stated.groups[fg_foil_traits_of(design->kind)->group].values = design->values;
  FG_TRY(fg_json_read(ctx, path, json, &root));
  fg_status status = read_design(&reading, root, &stated);
  cJSON_Delete(root);
  if (status == FG_OK) status = check_design(&reading, &stated);
  if (status == FG_OK) *design = stated.design;
  return status;
}

/* A relative path begins at the design's folder. */
static fg_status place_certificate(fg_context *ctx, const char *path, fg_design *design) {
  char *certificate = design->grid.certificate, whole[FG_CERTIFICATE_PATH];
  const char *slash = strrchr(path, '/');
  if (!certificate[0] || certificate[0] == '/' || !slash) return FG_OK;
  int length = snprintf(whole, sizeof whole, "%.*s%s", (int)(slash - path + 1), path, certificate);
  if (length >= (int)sizeof whole)
    return fg_fail(ctx, FG_ERR_DATA, "%.200s: the certificate's path is too long", path);
  strcpy(certificate, whole);
  return FG_OK;
}

fg_status fg_design_load(fg_context *ctx, const char *path, fg_design *design) {
  char *text = NULL;
  FG_TRY(fg_file_read_text(ctx, path, DESIGN_BYTES_MAX, &text));
  fg_status status = fg_design_parse(ctx, path, text, design);
  free(text);
  if (status == FG_OK && fg_foil_traits_of(design->kind)->is_grid)
    status = place_certificate(ctx, path, design);
  return status;
}

void fg_json_design(fg_json *json, const char *name, const fg_design *design) {
  fg_json_object(json, name);
  fg_members_json(json, &fg_design_members, &(fg_subject){.object = design, .whole = design});
  fg_json_object_end(json);
}
