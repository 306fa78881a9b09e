/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/driver.h"

#include <math.h>
#include <stdio.h>

static const double FULL_SCALE = 255;

static fg_status read_tone_point(const fg_place *place, size_t index, const cJSON *item,
                                 fg_tone_curve *tone) {
  char name[32], what[128];
  snprintf(name, sizeof name, "tone_curve[%zu]", index);
  if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 2)
    return fg_member_fail(place, name, item, "must be [in, out]");
  fg_place inner = fg_place_inside(place, name);
  FG_TRY(fg_member_number(&inner, "in", item->child, 0, FULL_SCALE, &tone->in[index]));
  FG_TRY(fg_member_number(&inner, "out", item->child->next, 0, FULL_SCALE, &tone->out[index]));
  if (index == 0) return FG_OK;
  double in = tone->in[index - 1], out = tone->out[index - 1];
  if (tone->in[index] > in && tone->out[index] >= out) return FG_OK;
  snprintf(what, sizeof what,
           "in must ascend and out must not fall, and the one before is [%g, %g]", in, out);
  return fg_member_fail(place, name, item, what);
}

/* Place of a count in the table: the last point at or below its whole part. */
static void index_tone(fg_tone_curve *tone) {
  size_t point = 0;
  for (int i = 0; i < FG_TONE_COUNTS; i++) {
    while (point + 1 < tone->count && tone->in[point + 1] <= i)
      point++;
    tone->first[i] = point;
  }
}

/* Reads the bits of the numbers before the curve. */
static fg_status read_tone_bits(const fg_place *place, const cJSON *scanner, fg_tone_curve *tone) {
  const cJSON *bits = cJSON_GetObjectItemCaseSensitive(scanner, "tone_bits");
  double number = 0;
  if (!bits) return FG_OK;
  if (!tone->count) return fg_member_fail(place, "tone_bits", bits, "belongs to tone_curve");
  FG_TRY(fg_member_number(place, "tone_bits", bits, 8, 16, &number));
  if (number != floor(number))
    return fg_member_fail(place, "tone_bits", bits, "must be a whole number");
  tone->bits = (int)number;
  return FG_OK;
}

static fg_status read_tone(const fg_place *place, const cJSON *scanner, fg_tone_curve *tone) {
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(scanner, "tone_curve");
  if (!array) return read_tone_bits(place, scanner, tone);
  if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) < 2 ||
      cJSON_GetArraySize(array) > FG_TONE_POINTS_MAX)
    return fg_member_fail(place, "tone_curve", array, "must be an array of 2 to 256 points");
  const cJSON *item;
  size_t index = 0;
  cJSON_ArrayForEach(item, array) FG_TRY(read_tone_point(place, index++, item, tone));
  tone->count = index;
  index_tone(tone);
  return read_tone_bits(place, scanner, tone);
}

static fg_status read_unsharp(const fg_place *place, const cJSON *object, fg_unsharp_mask *mask) {
  static const fg_spec_row table[] = {
      {"amount_pct", FG_SPEC_NUMBER, offsetof(fg_unsharp_mask, amount_pct), 0, 1000},
      {"radius_px", FG_SPEC_NUMBER, offsetof(fg_unsharp_mask, radius_px), 0.1, 30},
      {"threshold", FG_SPEC_NUMBER, offsetof(fg_unsharp_mask, threshold), 0, 255},
      {0}};
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, "unsharp_mask");
  FG_TRY(fg_members_read(&inner, object, table, mask));
  if (!cJSON_GetObjectItemCaseSensitive(object, "amount_pct"))
    return fg_member_fail(&inner, "amount_pct", NULL, "say how much, in percent");
  return FG_OK;
}

static fg_status read_levels(const fg_place *place, const cJSON *scanner, int bits,
                             fg_driver_settings *settings) {
  const cJSON *levels = cJSON_GetObjectItemCaseSensitive(scanner, "levels");
  const cJSON *threshold = cJSON_GetObjectItemCaseSensitive(scanner, "threshold");
  double number = 0;
  if (levels) FG_TRY(fg_member_number(place, "levels", levels, 2, 1 << bits, &number));
  if (number != floor(number))
    return fg_member_fail(place, "levels", levels, "must be a whole number");
  settings->levels = (int)number;
  if (!threshold) return FG_OK;
  if (settings->levels != 2)
    return fg_member_fail(place, "threshold", threshold, "belongs to two levels: \"levels\": 2");
  return fg_member_number(place, "threshold", threshold, 0, FULL_SCALE, &settings->threshold);
}

fg_status fg_driver_read(const fg_place *place, const cJSON *scanner, int bits,
                         fg_driver_settings *settings) {
  FG_TRY(read_tone(place, scanner, &settings->tone));
  FG_TRY(read_unsharp(place, cJSON_GetObjectItemCaseSensitive(scanner, "unsharp_mask"),
                      &settings->unsharp));
  return read_levels(place, scanner, bits, settings);
}

float fg_tone_curve_value(const fg_tone_curve *tone, float count) {
  double at = (double)count, steps = (double)((1 << tone->bits) - 1) / FULL_SCALE;
  if (tone->bits) at = floor(at * steps + 0.5) / steps;
  size_t last = tone->count - 1;
  if (at <= tone->in[0]) return (float)tone->out[0];
  if (at >= tone->in[last]) return (float)tone->out[last];
  size_t i = tone->first[(int)at];
  while (at >= tone->in[i + 1])
    i++;
  double share = (at - tone->in[i]) / (tone->in[i + 1] - tone->in[i]);
  return (float)(tone->out[i] + share * (tone->out[i + 1] - tone->out[i]));
}
