/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/family_members.h"

#include <stdio.h>
#include <string.h>

#include "core/text.h"

#define SHARE(name, kind, meaning)                                                                 \
  { FG_NUMBER(name, fg_loop_result, share[kind]), .lowest = 0, .highest = 1, .words = meaning }

static const fg_member share_rows[] = {
    SHARE("columns", FG_LOOP_KIND_COLUMNS, "levels, slopes and bends over a recorded column"),
    SHARE("interactions", FG_LOOP_KIND_INTERACTIONS, "of two columns"),
    SHARE("curves", FG_LOOP_KIND_CURVES, "steps, cycles and free curves over a column"),
    SHARE("order", FG_LOOP_KIND_ORDER,
          "everything over the order of the rows, correlation of neighbours included"),
    SHARE("scatter", FG_LOOP_KIND_SCATTER, "a scatter that changes"),
    SHARE("rows", FG_LOOP_KIND_ROWS, "single wrong rows"),
    SHARE("exchanges", FG_LOOP_KIND_EXCHANGES, "two exchanged responses"),
};
const fg_members fg_loop_share_members = FG_MEMBERS(share_rows);

void fg_loop_shares_words(const fg_loop_result *result, char text[FG_LOOP_WORDS]) {
  *text = 0;
  for (size_t k = 0; k < FG_LOOP_KINDS; k++) {
    size_t used = strlen(text);
    fg_text_clip(text + used, FG_LOOP_WORDS - used, "%s%s %.0f %%", k ? ", " : "",
                 fg_loop_kind_words[k], 100 * result->share[k]);
  }
}
