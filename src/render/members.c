/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/members.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

fg_place fg_place_inside(const fg_place *place, const char *name) {
  fg_place inner = {.ctx = place->ctx, .path = place->path};
  snprintf(inner.member, sizeof inner.member, "%.100s%s%.50s", place->member,
           place->member[0] ? "." : "", name);
  return inner;
}

fg_place fg_place_item(const fg_place *place, const char *name, int index) {
  char numbered[80];
  snprintf(numbered, sizeof numbered, "%.50s[%d]", name, index);
  return fg_place_inside(place, numbered);
}

fg_status fg_member_fail(const fg_place *place, const char *name, const cJSON *item,
                         const char *what) {
  fg_place inner = *name ? fg_place_inside(place, name) : *place;
  const char *member = inner.member[0] ? inner.member : "the spec";
  if (!item)
    return fg_fail(place->ctx, FG_ERR_DATA, "%s: %s is missing: %s", place->path, member, what);
  char *value = cJSON_PrintUnformatted(item);
  fg_fail(place->ctx, FG_ERR_DATA, "%s: %s is %.60s: %s", place->path, member, value ? value : "?",
          what);
  free(value);
  return FG_ERR_DATA;
}

fg_status fg_member_number(const fg_place *place, const char *name, const cJSON *item, double low,
                           double high, double *value) {
  char what[96];
  snprintf(what, sizeof what, "must be a number from %g to %g", low, high);
  if (!cJSON_IsNumber(item)) return fg_member_fail(place, name, item, what);
  if (!(item->valuedouble >= low && item->valuedouble <= high))
    return fg_member_fail(place, name, item, what);
  *value = item->valuedouble;
  return FG_OK;
}

fg_status fg_member_numbers(const fg_place *place, const char *name, const cJSON *item,
                            fg_array_limits limits, double *values, int *count) {
  char what[96];
  snprintf(what, sizeof what, "must be an array of %d to %d numbers", limits.min, limits.max);
  if (!cJSON_IsArray(item)) return fg_member_fail(place, name, item, what);
  int size = cJSON_GetArraySize(item);
  if (size < limits.min || size > limits.max) return fg_member_fail(place, name, item, what);
  int index = 0;
  const cJSON *entry;
  cJSON_ArrayForEach(entry, item) {
    char numbered[80];
    snprintf(numbered, sizeof numbered, "%.50s[%d]", name, index);
    FG_TRY(fg_member_number(place, numbered, entry, limits.low, limits.high, &values[index]));
    index++;
  }
  *count = size;
  return FG_OK;
}

static fg_status read_one(const fg_place *place, const cJSON *item, const fg_spec_row *row,
                          void *base) {
  char *target = (char *)base + row->offset;
  double number = 0;
  switch (row->kind) {
  case FG_SPEC_NUMBER:
    FG_TRY(fg_member_number(place, row->name, item, row->low, row->high, &number));
    memcpy(target, &number, sizeof number);
    return FG_OK;
  case FG_SPEC_INTEGER: {
    FG_TRY(fg_member_number(place, row->name, item, row->low, row->high, &number));
    if (number != floor(number))
      return fg_member_fail(place, row->name, item, "must be a whole number");
    int whole = (int)number;
    memcpy(target, &whole, sizeof whole);
    return FG_OK;
  }
  case FG_SPEC_BOOL: {
    if (!cJSON_IsBool(item)) return fg_member_fail(place, row->name, item, "must be true or false");
    bool truth = cJSON_IsTrue(item);
    memcpy(target, &truth, sizeof truth);
    return FG_OK;
  }
  case FG_SPEC_OTHER:
  case FG_SPEC_END:
    return FG_OK;
  }
  return FG_OK;
}

static fg_status fail_unknown(const fg_place *place, const cJSON *item, const fg_spec_row *table) {
  char what[400] = "there is no such member";
  size_t length = strlen(what);
  for (const fg_spec_row *row = table; row->kind != FG_SPEC_END && length < sizeof what; row++)
    length += (size_t)snprintf(what + length, sizeof what - length, "%s%s",
                               row == table ? "; there are " : ", ", row->name);
  return fg_member_fail(place, item->string, item, what);
}

fg_status fg_members_read(const fg_place *place, const cJSON *object, const fg_spec_row *table,
                          void *base) {
  if (!cJSON_IsObject(object)) return fg_member_fail(place, "", object, "must be an object");
  const cJSON *item;
  cJSON_ArrayForEach(item, object) {
    const fg_spec_row *row = table;
    while (row->kind != FG_SPEC_END && strcmp(row->name, item->string) != 0)
      row++;
    if (row->kind == FG_SPEC_END) return fail_unknown(place, item, table);
    if (cJSON_GetObjectItemCaseSensitive(object, item->string) != item)
      return fg_member_fail(place, item->string, item, "given twice");
    FG_TRY(read_one(place, item, row, base));
  }
  return FG_OK;
}

fg_status fg_member_choice(const fg_place *place, const cJSON *object, const char *name,
                           const char *const words[2], int *choice) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!item) return FG_OK;
  for (int i = 0; i < 2; i++)
    if (cJSON_IsString(item) && !strcmp(item->valuestring, words[i])) {
      *choice = i;
      return FG_OK;
    }
  char what[64];
  snprintf(what, sizeof what, "must be \"%s\" or \"%s\"", words[0], words[1]);
  return fg_member_fail(place, name, item, what);
}
