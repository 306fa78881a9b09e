/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON from text, with an error for exhausted memory apart from that for bad text: cJSON returns
 * NULL for both. */
#ifndef FG_CORE_JSON_READ_H
#define FG_CORE_JSON_READ_H

#include <cjson/cJSON.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* Parses the whole text; white space around it is allowed. FG_ERR_DATA names `path`, line, column
 * and the text found there; FG_ERR_MEMORY. The caller deletes `root`, which is NULL after an error.
 */
fg_status fg_json_read(fg_context *ctx, const char *path, const char *text, cJSON **root);

/* Description of a member of a JSON file that people write. It stands beside the code that reads
 * the member; the manual and its test list the members from there. */
typedef struct fg_member_words {
  char name[64];   /* "assembly.seed" */
  char usual[64];  /* default where the file omits the member, as JSON; "": none, or the member is
                      required */
  char limits[64]; /* "0.5 to 0.9999"; "": none */
  const char *meaning; /* NULL is an error of the table */
} fg_member_words;

/* Fills a list and returns the number of members, which may be more than `max`. */
typedef size_t fg_member_words_list(fg_member_words *list, size_t max);

fg_member_words_list fg_recipe_members, fg_station_members;

#endif
