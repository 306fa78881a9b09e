/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of JSON objects as rows of a table: name, kind, place in a struct, allowed range. */
#ifndef FG_RENDER_MEMBERS_H
#define FG_RENDER_MEMBERS_H

#include <stdbool.h>
#include <stddef.h>

#include <cjson/cJSON.h>

#include "foilgauge/status.h"

typedef enum fg_spec_row_kind {
  FG_SPEC_END,
  FG_SPEC_NUMBER,  /* double */
  FG_SPEC_INTEGER, /* int */
  FG_SPEC_BOOL,    /* bool */
  FG_SPEC_OTHER,   /* known, but read by the caller */
} fg_spec_row_kind;

typedef struct fg_spec_row {
  const char *name;
  fg_spec_row_kind kind;
  size_t offset;
  double low, high; /* of numbers, both allowed */
} fg_spec_row;

/* Place in a file, for messages. */
typedef struct fg_place {
  fg_context *ctx;
  const char *path;
  char member[160]; /* "foils[0].design", empty at the top */
} fg_place;

fg_place fg_place_inside(const fg_place *place, const char *name);
fg_place fg_place_item(const fg_place *place, const char *name, int index);

/* "<path>: <place>.<name> is <value>: <what>" as FG_ERR_DATA; `item` may be NULL: missing. */
fg_status fg_member_fail(const fg_place *place, const char *name, const cJSON *item,
                         const char *what);

/* Reads the members of `object` into `base`; absent ones keep their value. FG_ERR_DATA for an
 * object that is none, unknown members, members given twice, wrong types and values out of
 * range. */
fg_status fg_members_read(const fg_place *place, const cJSON *object, const fg_spec_row *table,
                          void *base);

fg_status fg_member_number(const fg_place *place, const char *name, const cJSON *item, double low,
                           double high, double *value);

/* Allowed values and lengths of an array of numbers. */
typedef struct fg_array_limits {
  double low, high; /* of a number, both allowed */
  int min, max;     /* numbers in the array, both allowed */
} fg_array_limits;

/* Reads an array of numbers; *count is their number. */
fg_status fg_member_numbers(const fg_place *place, const char *name, const cJSON *item,
                            fg_array_limits limits, double *values, int *count);

/* Reads one of two words, as its number; absent: *choice stays. */
fg_status fg_member_choice(const fg_place *place, const cJSON *object, const char *name,
                           const char *const words[2], int *choice);

#endif
