/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The different cells of a column of the manifest. */
#ifndef FG_LOT_INPUT_MANIFEST_WORDS_H
#define FG_LOT_INPUT_MANIFEST_WORDS_H

#include "lot/statistics/analysis.h"

enum { FG_MANIFEST_WORDS_MAX = 4096 };

/* In order of appearance; the words belong to the manifest. */
typedef struct fg_manifest_words {
  const char *word[FG_MANIFEST_WORDS_MAX];
  size_t count;
} fg_manifest_words;

/* The word's place, which is added where it is new; FG_MANIFEST_WORDS_MAX when there is no room. */
size_t fg_manifest_word_index(fg_manifest_words *words, const char *word);

/* Cells of the lot's foils that are not empty. */
void fg_lot_list_words(const fg_lot_analysis *analysis, size_t column, fg_manifest_words *words);

#endif
