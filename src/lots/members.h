/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lots over time: the rows of JSON, CSV and the page's tables. */
#ifndef FG_LOTS_MEMBERS_H
#define FG_LOTS_MEMBERS_H

#include "core/member.h"

extern const fg_document fg_index_document;

/* Elements: fg_index_lot; fg_index_spread of the lot or die at the subject's index; fg_index_pair
 * of lots; fg_index_die_pair. */
extern const fg_members fg_index_lot_members, fg_index_lot_spread_members,
    fg_index_die_spread_members, fg_index_pair_members, fg_index_die_pair_members;

extern const fg_members fg_index_comparison_members, fg_index_prediction_members;

/* Words of fg_index_scale, in its order. */
extern const char *const fg_index_scale_words[];

#define FG_INDEX_SCALE_WORDS                                                                       \
  "over_design: the designs differ, each value over its own design's; apart: they differ and "     \
  "state no value, so lots are not compared"

/* Of lots that were read, and of dies. */
fg_member_element fg_index_read_lot_at, fg_index_lot_spread_at, fg_index_die_spread_at;

/* Tables of the page are set close. */
#define FG_INDEX_TABLE(rows_, definition_, look_)                                                  \
  {                                                                                                \
    .rows = (rows_), .count = sizeof(rows_) / sizeof *(rows_), .definition = (definition_),        \
    .look = (look_), .frame = "lots"                                                               \
  }

#endif
