/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads JSON into a struct by the rows of its members (core/member.h).
 *
 * A member that is absent keeps the value that the struct has before: fill it with the defaults.
 * Unknown and doubled members, wrong types, numbers beyond the row's limits, words that are no
 * choice, texts that do not fit or hold a control character, and required members that are missing
 * are FG_ERR_DATA; the message names the member with the objects around it. null is read where the
 * row is written as null, and gives 0.
 */
#ifndef FG_CORE_MEMBER_READ_H
#define FG_CORE_MEMBER_READ_H

#include <cjson/cJSON.h>

#include "core/member.h"

enum { FG_READING_PLACE = 160 };

typedef struct fg_reading {
  fg_context *ctx;
  const char *path;    /* of the file, before every message; NULL: the caller adds it */
  const char *between; /* a member's name and the words about it: " " or ": " */
  const void *user;    /* for readers of rows */
  bool has_others;     /* members without a row are skipped */
  /* Struct that the row's value goes into; NULL: the object itself. */
  void *(*object_of)(const fg_member *member, void *object);
  char place[FG_READING_PLACE]; /* names of the objects around, "check"; "": the root */
} fg_reading;

/* Reads all members of an object. */
fg_status fg_object_read(const fg_reading *reading, const fg_members *members, const cJSON *item,
                         void *object);

/* Checks the limits of all numbers of an object that was not read. */
fg_status fg_object_check(const fg_reading *reading, const fg_members *members, const void *object);

/* Reads the elements of an array into a LIST or MAP in the struct; for readers that do more. */
fg_status fg_member_read(const fg_reading *reading, const fg_member *member, const cJSON *item,
                         void *object);

/* Reading inside the member of this name. */
fg_reading fg_reading_inside(const fg_reading *reading, const char *name);

/* FG_ERR_DATA with the member's whole name before the words; name NULL: of the object itself. */
fg_status fg_reading_fail(const fg_reading *reading, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
