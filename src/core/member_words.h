/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What there is to say of a member of a JSON file that people write. Where it is read stands what
 * it means; the manual and its test list it from there. */
#ifndef FG_CORE_MEMBER_WORDS_H
#define FG_CORE_MEMBER_WORDS_H

#include <stddef.h>

typedef struct fg_member_words {
  char name[64];   /* "assembly.seed" */
  char usual[64];  /* where the file does not say it, as JSON; "": nothing, or it must be said */
  char limits[64]; /* "0.5 to 0.9999"; "": none */
  const char *meaning; /* NULL: somebody forgot it */
} fg_member_words;

/* Fills a list and returns how many there are, which may be more than `most`. */
typedef size_t fg_member_words_list(fg_member_words *list, size_t max);

fg_member_words_list fg_recipe_members, fg_station_members, fg_design_members;

#endif
