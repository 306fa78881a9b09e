/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/jumps.h"

#include <math.h>
#include <stdio.h>

enum { ROWS_MAX = 1000 };

/* Finds the array of a member, NULL without; FG_ERR_DATA when it is too long or no array. */
static fg_status find_array(const fg_place *place, const cJSON *scanner, const char *name,
                            const cJSON **array) {
  *array = cJSON_GetObjectItemCaseSensitive(scanner, name);
  if (!*array || (cJSON_IsArray(*array) && cJSON_GetArraySize(*array) <= FG_RENDER_JUMPS_MAX))
    return FG_OK;
  return fg_member_fail(place, name, *array, "must be an array of at most 64 objects");
}

static fg_status read_rows_lost(const fg_place *place, const cJSON *scanner,
                                fg_jump_requests *requests) {
  static const fg_spec_row table[] = {
      {"y_mm", FG_SPEC_NUMBER, offsetof(fg_rows_lost, y_mm), 0, 10000},
      {"count", FG_SPEC_INTEGER, offsetof(fg_rows_lost, count), -ROWS_MAX, ROWS_MAX},
      {0}};
  const cJSON *array, *item;
  FG_TRY(find_array(place, scanner, "rows_lost", &array));
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "rows_lost", (int)requests->row_count);
    fg_rows_lost *lost = &requests->rows[requests->row_count++];
    *lost = (fg_rows_lost){.y_mm = NAN};
    FG_TRY(fg_members_read(&inner, item, table, lost));
    if (isnan(lost->y_mm)) return fg_member_fail(&inner, "y_mm", NULL, "say behind which place");
    if (!lost->count)
      return fg_member_fail(&inner, "count", cJSON_GetObjectItemCaseSensitive(item, "count"),
                            "say how many rows are lost; negative: read again");
  }
  return FG_OK;
}

static fg_status read_seams(const fg_place *place, const cJSON *scanner,
                            fg_jump_requests *requests) {
  static const fg_spec_row table[] = {
      {"x_mm", FG_SPEC_NUMBER, offsetof(fg_chip_seam, x_mm), 0, 10000},
      {"shift_um", FG_SPEC_NUMBER, offsetof(fg_chip_seam, shift_um), -500, 500},
      {"shift_y_um", FG_SPEC_NUMBER, offsetof(fg_chip_seam, shift_y_um), -500, 500},
      {0}};
  const cJSON *array, *item;
  FG_TRY(find_array(place, scanner, "chip_seams", &array));
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "chip_seams", (int)requests->seam_count);
    fg_chip_seam *seam = &requests->seams[requests->seam_count++];
    *seam = (fg_chip_seam){.x_mm = NAN};
    FG_TRY(fg_members_read(&inner, item, table, seam));
    if (isnan(seam->x_mm)) return fg_member_fail(&inner, "x_mm", NULL, "say where the seam is");
    if (seam->shift_um == 0 && seam->shift_y_um == 0)
      return fg_member_fail(&inner, "shift_um", cJSON_GetObjectItemCaseSensitive(item, "shift_um"),
                            "say by how much the picture jumps, or shift_y_um");
  }
  return FG_OK;
}

static fg_status read_stitches(const fg_place *place, const cJSON *scanner,
                               fg_jump_requests *requests) {
  static const fg_spec_row table[] = {
      {"y_mm", FG_SPEC_NUMBER, offsetof(fg_stitch, y_mm), 0, 10000},
      {"rows", FG_SPEC_INTEGER, offsetof(fg_stitch, rows), -ROWS_MAX, ROWS_MAX},
      {"shift_um", FG_SPEC_NUMBER, offsetof(fg_stitch, shift_um), -500, 500},
      {0}};
  const cJSON *array, *item;
  FG_TRY(find_array(place, scanner, "stitches", &array));
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "stitches", (int)requests->stitch_count);
    fg_stitch *stitch = &requests->stitches[requests->stitch_count++];
    *stitch = (fg_stitch){.y_mm = NAN};
    FG_TRY(fg_members_read(&inner, item, table, stitch));
    if (isnan(stitch->y_mm)) return fg_member_fail(&inner, "y_mm", NULL, "say behind which place");
    if (!stitch->rows && stitch->shift_um == 0)
      return fg_member_fail(&inner, "rows", cJSON_GetObjectItemCaseSensitive(item, "rows"),
                            "say how many rows are left out (negative: come twice), or shift_um");
  }
  return FG_OK;
}

fg_status fg_jumps_read(const fg_place *place, const cJSON *scanner, fg_jump_requests *requests) {
  FG_TRY(read_rows_lost(place, scanner, requests));
  FG_TRY(read_stitches(place, scanner, requests));
  return read_seams(place, scanner, requests);
}

static fg_status check_inside(const fg_place *place, const char *name, size_t index, double at_mm,
                              double size_mm) {
  if (at_mm < size_mm) return FG_OK;
  return fg_fail(place->ctx, FG_ERR_DATA,
                 "%s: scanner.%s[%zu] is at %g mm: must be within the picture's %g mm", place->path,
                 name, index, at_mm, size_mm);
}

/* Returns the middle between the last pixel before the place and the first one beyond it. */
static double between_pixels(double at_mm, double pixel_mm) {
  return (floor(at_mm / pixel_mm) + 0.5) * pixel_mm;
}

/* Jump of lost rows: they are one jump. A carriage that stands still falls back by one row at every
 * row that it reads again. */
static fg_render_jump rows_jump(const fg_rows_lost *lost, double pitch_mm) {
  bool again = lost->count < 0;
  return (fg_render_jump){.axis = 1,
                          .at_mm = between_pixels(lost->y_mm, pitch_mm),
                          .every_mm = pitch_mm,
                          .repeats = again ? -lost->count : 1,
                          .d_mm = {0, again ? -pitch_mm : lost->count * pitch_mm}};
}

fg_status fg_jumps_build(const fg_place *place, const fg_jump_requests *requests,
                         const double pixel_mm[2], const double size_mm[2],
                         fg_render_jump_list *list) {
  list->count = 0;
  for (size_t i = 0; i < requests->row_count; i++) {
    FG_TRY(check_inside(place, "rows_lost", i, requests->rows[i].y_mm, size_mm[1]));
    list->each[list->count++] = rows_jump(&requests->rows[i], pixel_mm[1]);
  }
  for (size_t i = 0; i < requests->stitch_count; i++) {
    const fg_stitch *stitch = &requests->stitches[i];
    FG_TRY(check_inside(place, "stitches", i, stitch->y_mm, size_mm[1]));
    list->each[list->count++] =
        (fg_render_jump){.axis = 1,
                         .at_mm = between_pixels(stitch->y_mm, pixel_mm[1]),
                         .every_mm = pixel_mm[1],
                         .repeats = 1,
                         .d_mm = {1e-3 * stitch->shift_um, stitch->rows * pixel_mm[1]}};
  }
  for (size_t i = 0; i < requests->seam_count; i++) {
    const fg_chip_seam *seam = &requests->seams[i];
    FG_TRY(check_inside(place, "chip_seams", i, seam->x_mm, size_mm[0]));
    list->each[list->count++] =
        (fg_render_jump){.at_mm = between_pixels(seam->x_mm, pixel_mm[0]),
                         .every_mm = pixel_mm[0],
                         .repeats = 1,
                         .d_mm = {1e-3 * seam->shift_um, 1e-3 * seam->shift_y_um}};
  }
  return FG_OK;
}

double fg_jumps_rows_more(const fg_jump_requests *requests) {
  double sum = 0;
  for (size_t i = 0; i < requests->row_count; i++)
    sum += fmax(0, -requests->rows[i].count);
  for (size_t i = 0; i < requests->stitch_count; i++)
    sum += fmax(0, -requests->stitches[i].rows);
  return sum;
}

void fg_jumps_field(const fg_render_jump_list *list, const double side_mm[2], double d_mm[2]) {
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_jump *jump = &list->each[i];
    double passed = ceil((side_mm[jump->axis] - jump->at_mm) / jump->every_mm);
    passed = fmin(fmax(passed, 0), jump->repeats);
    d_mm[0] += passed * jump->d_mm[0];
    d_mm[1] += passed * jump->d_mm[1];
  }
}

double fg_jumps_next(const fg_render_jump_list *list, int axis, double low_mm, double high_mm) {
  double next = NAN;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_jump *jump = &list->each[i];
    double k = fmax(0, ceil((low_mm - jump->at_mm) / jump->every_mm));
    double at = jump->at_mm + k * jump->every_mm;
    if (jump->axis != axis || k >= jump->repeats || !(at < high_mm)) continue;
    next = fmin(next, at); /* fmin prefers the number to NaN */
  }
  return next;
}

double fg_jumps_reach_mm(const fg_render_jump_list *list) {
  double reach = 0;
  for (size_t i = 0; i < list->count; i++)
    reach += list->each[i].repeats * hypot(list->each[i].d_mm[0], list->each[i].d_mm[1]);
  return reach;
}
