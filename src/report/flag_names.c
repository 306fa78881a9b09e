/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/flag_names.h"

#include <string.h>

#include "core/text.h"
#include "foilgauge/picture.h"

static const char *word_at(const fg_flag_words *words, unsigned flags, size_t *i) {
  for (; words->name; words++)
    if ((*i)-- == 0) return flags & words->flag ? words->name : "";
  return NULL;
}

const char *fg_flag_name_at(const fg_flag_words *words, unsigned flags, unsigned findings,
                            size_t i) {
  const char *name = word_at(words, flags, &i);
  for (const fg_picture_words *found = fg_picture_finding_words(); !name && found->name; found++)
    if (i-- == 0) name = findings & found->finding ? found->name : "";
  return name;
}

void fg_flag_names(const fg_flag_words *words, unsigned flags, unsigned findings, char *text,
                   size_t size) {
  const char *name;
  size_t used = 0;
  text[0] = '\0';
  for (size_t i = 0; (name = fg_flag_name_at(words, flags, findings, i)) != NULL; i++)
    if (*name && used < size) {
      fg_text_clip(text + used, size - used, "%s%s", used ? " " : "", name);
      used += strlen(text + used);
    }
}

const char *fg_foil_flag_choice(size_t i) {
  return fg_flag_name_at(fg_foil_flag_words(), ~0u, ~0u, i);
}

const char *fg_disc_flag_choice(size_t i) {
  return fg_flag_name_at(fg_bump_flag_words(), ~0u, ~0u, i);
}

const char *fg_bump_flag_choice(size_t i) {
  return word_at(fg_bump_flag_words(), ~0u, &i);
}

const char *fg_beam_flag_choice(size_t i) {
  return word_at(fg_beam_flag_words(), ~0u, &i);
}

const char *fg_finding_choice(size_t i) {
  static const fg_flag_words none = {0, NULL, NULL};
  return fg_flag_name_at(&none, 0, ~0u, i);
}

void fg_json_flag_names(fg_json *json, const fg_flag_words *words, unsigned flags,
                        unsigned findings) {
  for (; words->name; words++)
    if (flags & words->flag) fg_json_string(json, NULL, words->name);
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++)
    if (findings & found->finding) fg_json_string(json, NULL, found->name);
}

void fg_csv_put_flags(FILE *out, const fg_flag_words *words, unsigned flags, unsigned findings) {
  const char *separator = "";
  fputc(',', out);
  for (; words->name; words++) {
    if (!(flags & words->flag)) continue;
    fprintf(out, "%s%s", separator, words->name);
    separator = " ";
  }
  for (const fg_picture_words *found = fg_picture_finding_words(); found->name; found++) {
    if (!(findings & found->finding)) continue;
    fprintf(out, "%s%s", separator, found->name);
    separator = " ";
  }
}
