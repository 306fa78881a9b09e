/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/input/manifest_words.h"

#include <string.h>

size_t fg_manifest_word_index(fg_manifest_words *words, const char *word) {
  for (size_t i = 0; i < words->count; i++)
    if (!strcmp(words->word[i], word)) return i;
  if (words->count == FG_MANIFEST_WORDS_MAX) return FG_MANIFEST_WORDS_MAX;
  words->word[words->count] = word;
  return words->count++;
}

void fg_lot_list_words(const fg_lot_analysis *analysis, size_t column, fg_manifest_words *words) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const char *word = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    if (*word) fg_manifest_word_index(words, word);
  }
}
