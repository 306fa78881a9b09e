/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the reports of die compensation. */
#ifndef FG_COMPENSATION_MEMBERS_H
#define FG_COMPENSATION_MEMBERS_H

#include "core/member.h"
#include "foilgauge/compensation.h"

extern const fg_document fg_next_die_document, fg_expected_document;

/* Elements: fg_die_bump_dimensions beside its expected bump; fg_formed_set; fg_expected_share;
 * the laws of the quantities. */
extern const fg_members fg_next_bump_members, fg_formed_set_members, fg_expected_share_members,
    fg_formed_law_members, fg_law_members, fg_setting_trade_members, fg_die_dimensions_members,
    fg_expected_bump_members;

fg_member_element fg_setting_trade_at, fg_next_bump_at, fg_formed_set_at, fg_expected_share_at,
    fg_formed_law_at;

/* Of a lot held against its prediction: elements fg_iteration and fg_expected_held_bump. */
extern const fg_members fg_iteration_members, fg_held_bump_members;
fg_member_element fg_iteration_at, fg_held_bump_at;

/* Writes the outcome of a next die in a sentence. */
void fg_next_die_sentence(const fg_next_die *next, char *text, size_t size);

/* Writes the choice of the heat treatment in a sentence. */
void fg_setting_sentence(const fg_next_die *next, char *text, size_t size);

/* Words of a quantity: "bump radius". */
const char *fg_formed_words(fg_formed formed);

#endif
