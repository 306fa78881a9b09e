/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/flag_names.h"

#include "foilgauge/picture.h"

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
