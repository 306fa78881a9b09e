/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pairs of lots and of dies, with the test of their difference. */
#include <stdio.h>

#include "lots/index.h"
#include "lots/members.h"

/* Limit of the listed pairs, those that differ most; `tested` and `differing` count all. */
enum { PAIRS_LISTED_MAX = 2000 };

const char *const fg_index_scale_words[] = {"as_is", "over_design", "apart", NULL};

static const fg_index *index_of(const fg_subject *subject) {
  return subject->whole;
}

static const fg_index_axis *axis_of_pair(const fg_subject *subject) {
  return &index_of(subject)->axes[((const fg_index_pair *)subject->object)->axis];
}

static const char *find_pair_quantity(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return axis_of_pair(subject)->row->name;
}

static int find_pair_scale(const fg_subject *subject) {
  return (int)axis_of_pair(subject)->scale;
}

static const char *find_pair_words(const fg_subject *subject, char *buffer) {
  const fg_index_axis *axis = axis_of_pair(subject);
  snprintf(buffer, FG_MEMBER_TEXT_MAX, "%s%s", axis->row->words,
           axis->scale == FG_INDEX_OVER_DESIGN ? ", over design" : "");
  return buffer;
}

static const char *find_pair_difference(const fg_subject *subject, char *buffer) {
  fg_index_difference(axis_of_pair(subject), subject->object, buffer, 96);
  return buffer;
}

static const char *find_pair_foils(const fg_subject *subject, char *buffer) {
  const fg_index_pair *pair = subject->object;
  snprintf(buffer, 60, "%zu, %zu", pair->foils_a, pair->foils_b);
  return buffer;
}

static const char *find_pair_p(const fg_subject *subject, char *buffer) {
  fg_index_p(((const fg_index_pair *)subject->object)->p_holm, buffer, 16);
  return buffer;
}

static double find_differs(const fg_subject *subject) {
  return ((const fg_index_pair *)subject->object)->p_holm < 1 - FG_INDEX_CONFIDENCE;
}

static const char *look_at_pair(const fg_subject *subject) {
  return find_differs(subject) != 0 ? "on" : NULL;
}

/* The names of a pair: folders of lots in JSON, number and name on the page; names of dies. */
#define PAIR_NAME(function, side, ...)                                                             \
  static const char *function(const fg_subject *subject, char *buffer) {                           \
    const fg_index *index = index_of(subject);                                                     \
    size_t i = ((const fg_index_pair *)subject->object)->side;                                     \
    snprintf(buffer, FG_MEMBER_TEXT_MAX, __VA_ARGS__);                                             \
    return buffer;                                                                                 \
  }
PAIR_NAME(find_larger_folder, a, "%s", index->lots[i].folder)
PAIR_NAME(find_smaller_folder, b, "%s", index->lots[i].folder)
PAIR_NAME(find_larger_lot, a, "%zu  %s", i + 1, index->lots[i].name)
PAIR_NAME(find_smaller_lot, b, "%zu  %s", i + 1, index->lots[i].name)
PAIR_NAME(find_larger_die, a, "%s", index->dies[i].name)
PAIR_NAME(find_smaller_die, b, "%s", index->dies[i].name)

static const fg_member pair_head_rows[] = {
    {FG_TEXT_BY("quantity", find_pair_quantity), .options = FG_MEMBER_NEVER_NULL,
     .words = "its name"},
    {FG_TEXT_BY("quantity", find_pair_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "quantity", .words = true}},
    {FG_WORD_BY("scale", find_pair_scale, fg_index_scale_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_INDEX_SCALE_WORDS},
};
static const fg_members pair_head_members = FG_MEMBERS(pair_head_rows);

static const fg_member pair_value_rows[] = {
    {FG_COUNT("foils_larger", fg_index_pair, foils_a), .words = "of the larger"},
    {FG_COUNT("foils_smaller", fg_index_pair, foils_b), .words = "of the smaller"},
    {FG_NUMBER_U("difference", fg_index_pair, difference, u), .words = "of the means of foils"},
    {FG_TEXT_BY("difference", find_pair_difference), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "difference of the means of foils, with its 95 % interval",
     .page = {.rank = 3, .heading = "by (95 %)"}},
    {FG_TEXT_BY("foils", find_pair_foils), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .heading = "foils"}},
    {FG_NUMBER("freedom", fg_index_pair, dof), .words = "degrees of freedom (Welch)",
     .page = {.rank = 3, .heading = "degrees of\nfreedom", .decimals = 1}},
    {FG_NUMBER("low", fg_index_pair, low), .words = "of the difference's 95 % interval"},
    {FG_NUMBER("high", fg_index_pair, high), .words = "of the difference's 95 % interval"},
    {FG_NUMBER("p", fg_index_pair, p), .words = "of this test alone"},
    {FG_NUMBER("p_holm", fg_index_pair, p_holm), .words = "of all tests as one family (Holm 1979)"},
    {FG_TEXT_BY("p_holm", find_pair_p), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "p-value, all tests as one family (Holm 1979)",
     .page = {.rank = 3, .heading = "p, Holm"}},
    {FG_FLAG_BY("differs", find_differs), .words = "beyond chance, by p_holm"},
};
static const fg_members pair_value_members = FG_MEMBERS(pair_value_rows);

static const fg_member lot_pair_rows[] = {
    {FG_SAME(&pair_head_members)},
    {FG_TEXT_BY("larger", find_larger_folder), .options = FG_MEMBER_NEVER_NULL,
     .words = "folder of the lot with the larger mean"},
    {FG_TEXT_BY("smaller", find_smaller_folder), .options = FG_MEMBER_NEVER_NULL,
     .words = "folder of the other"},
    {FG_TEXT_BY("larger", find_larger_lot), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "larger in lot", .words = true}},
    {FG_TEXT_BY("smaller", find_smaller_lot), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "than in", .words = true}},
    {FG_SAME(&pair_value_members)},
};
const fg_members fg_index_pair_members = FG_INDEX_TABLE(lot_pair_rows, "pair", look_at_pair);

static bool find_listed_pair(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object = &index->pairs[i];
  return i < index->pair_count && i < PAIRS_LISTED_MAX;
}

static const char *const basis_words[] = {"within_lots", "between_lots", "not_separable", NULL};

static const char *find_basis(const fg_subject *subject, char *buffer) {
  const fg_index_die_pair *pair = subject->object;
  if (pair->basis == FG_INDEX_CONFOUNDED) return "not separable from the lots";
  snprintf(buffer, 80, "%s %zu lot%s",
           pair->basis == FG_INDEX_WITHIN_LOTS ? "within" : "between means of", pair->lots,
           pair->lots == 1 ? "" : "s");
  return buffer;
}

/* The pair is the first field of an fg_index_die_pair. */
static const fg_member die_pair_rows[] = {
    {FG_SAME(&pair_head_members)},
    {FG_TEXT_BY("larger", find_larger_die), .options = FG_MEMBER_NEVER_NULL,
     .words = "die with the larger mean",
     .page = {.rank = 2, .heading = "larger of die", .words = true}},
    {FG_TEXT_BY("smaller", find_smaller_die), .options = FG_MEMBER_NEVER_NULL, .words = "the other",
     .page = {.rank = 2, .heading = "than of", .words = true}},
    {FG_SAME(&pair_value_members)},
    {FG_WORD("basis", fg_index_die_pair, basis, basis_words),
     .words = "foils of both dies in the same lots; means of lots that have one of them; neither"},
    {FG_COUNT("lots", fg_index_die_pair, lots), .words = "that the comparison rests on"},
    {FG_TEXT_BY("basis", find_basis), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 4, .heading = "by what", .words = true}},
};
const fg_members fg_index_die_pair_members =
    FG_INDEX_TABLE(die_pair_rows, "die_pair", look_at_pair);

static double find_confidence(const fg_subject *subject) {
  (void)subject;
  return FG_INDEX_CONFIDENCE;
}

static const fg_member comparison_rows[] = {
    {FG_COUNT("tested", fg_index, pair_count), .words = "pairs, in all quantities"},
    {FG_COUNT("differing", fg_index, differing), .words = "of them"},
    {FG_NUMBER_BY("confidence", find_confidence), .options = FG_MEMBER_NEVER_NULL,
     .words = "of intervals and of `differs`"},
    {FG_LIST_BY("pairs", find_listed_pair, &fg_index_pair_members), .options = FG_MEMBER_ON_LINE,
     .highest = PAIRS_LISTED_MAX,
     .words = "by p-value, 2000 at most; lots are named by their folders"},
};
const fg_members fg_index_comparison_members = FG_MEMBERS(comparison_rows);
