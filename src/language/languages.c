/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The languages that the program has, and the choice of one. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "language/catalogue.h"

struct fg_languages {
  fg_language *list;
  size_t count;
};

static size_t count_lists(void) {
  size_t count = 0;
  while (fg_language_lists[count].file)
    count++;
  return count;
}

static fg_status read_lists(fg_context *ctx, fg_languages *languages, size_t count) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *languages->list, &block));
  languages->list = block;
  for (size_t i = 0; i < count; i++) {
    const fg_language_list *list = &fg_language_lists[i];
    languages->count++;
    FG_TRY(fg_catalogue_read(ctx, list->file, list->text, &languages->list[i]));
  }
  return FG_OK;
}

fg_status fg_languages_open(fg_context *ctx, fg_languages **languages) {
  void *block;
  *languages = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **languages, &block));
  fg_status status = read_lists(ctx, block, count_lists());
  if (status == FG_OK)
    *languages = block;
  else
    fg_languages_close(block);
  return status;
}

void fg_languages_close(fg_languages *languages) {
  if (!languages) return;
  for (size_t i = 0; i < languages->count; i++)
    fg_catalogue_free(&languages->list[i]);
  free(languages->list);
  free(languages);
}

const char *fg_language_tag(const fg_language *language) {
  return language->tag;
}

char fg_language_decimal(const fg_language *language) {
  return language->decimal;
}

/* "de-AT" is "de". */
static bool is_tag(const char *tag, const char *given, size_t length) {
  size_t own = strlen(tag);
  return length >= own && !strncasecmp(tag, given, own) && (length == own || given[own] == '-');
}

bool fg_language_is_known(const char *tag) {
  if (!strcmp(tag, "en")) return true;
  for (size_t i = 0; fg_language_lists[i].file; i++) {
    const char *file = fg_language_lists[i].file; /* "de.po" */
    if (strlen(tag) == strcspn(file, ".") && !strncmp(tag, file, strlen(tag))) return true;
  }
  return false;
}

/* Finds the language of a tag; false: the program has it not. *found NULL: English. */
static bool find_tag(const fg_languages *languages, const char *tag, size_t length,
                     const fg_language **found) {
  *found = NULL;
  if (is_tag("en", tag, length)) return true;
  for (size_t i = 0; i < languages->count && !*found; i++)
    if (is_tag(languages->list[i].tag, tag, length)) *found = &languages->list[i];
  return *found != NULL;
}

/* Weight of one of a browser's languages, "de;q=0.7"; 1 without. */
static double find_weight(const char *item, size_t length) {
  const char *weight = memmem(item, length, "q=", 2);
  return weight ? strtod(weight + 2, NULL) : 1;
}

/* Of languages of the same weight the first one is taken. */
static const fg_language *choose_accepted(const fg_languages *languages, const char *accepted) {
  const fg_language *best = NULL, *found;
  double weight_max = 0;
  while (*accepted) {
    accepted += strspn(accepted, ", ");
    size_t length = strcspn(accepted, ","), tag = strcspn(accepted, ",; ");
    double weight = find_weight(accepted, length);
    if (weight > weight_max && find_tag(languages, accepted, tag, &found)) {
      best = found;
      weight_max = weight;
    }
    accepted += length;
  }
  return best;
}

const fg_language *fg_languages_choose(const fg_languages *languages, const char *recipe,
                                       const char *accepted) {
  const fg_language *named;
  if (!languages) return NULL;
  if (recipe && *recipe && find_tag(languages, recipe, strlen(recipe), &named)) return named;
  return accepted ? choose_accepted(languages, accepted) : NULL;
}
