/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/suspect_members.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "report/table_loop/claim_members.h"
#include "report/table_loop/reading.h"

static const fg_loop_suspect *suspect_of(const fg_subject *subject) {
  return subject->object;
}

bool fg_loop_find_suspect(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_loop_result *result = ((const fg_loop_report *)list->whole)->result;
  if (i >= result->suspects) return false;
  element->object = &result->suspect[i];
  return true;
}

static const char *find_suspect_id(const fg_subject *suspect, char *buffer) {
  (void)buffer;
  return suspect_of(suspect)->claim.candidate.effect->id;
}

static const char *suspect_coordinate_at(const fg_subject *suspect, size_t i) {
  const fg_loop_candidate *candidate = &suspect_of(suspect)->claim.candidate;
  const fg_loop_problem *problem = &((const fg_loop_report *)suspect->whole)->problem->problem;
  if (candidate->effect->outlier != FG_LOOP_NOT_OUTLIER || i > candidate->effect->pair) return NULL;
  return problem->coordinate[i ? candidate->b : candidate->a].name;
}

static bool is_of_single_rows(const fg_subject *suspect) {
  return suspect_of(suspect)->claim.candidate.effect->outlier != FG_LOOP_NOT_OUTLIER;
}

static void put_rows(size_t count, const char *what, char text[FG_LOOP_WORDS]) {
  fg_text_clip(text, FG_LOOP_WORDS, "%zu %s", count, what);
}

void fg_loop_suspect_decides(const fg_loop_report *report, const fg_loop_suspect *suspect,
                             char text[FG_LOOP_WORDS]) {
  char rows[FG_LOOP_WORDS];
  size_t more = suspect->more_rows;
  if (suspect->repeats && more) {
    fg_loop_rows_words(report, &suspect->claim.candidate, rows);
    fg_text_clip(text, FG_LOOP_WORDS, "%zu repeat%s of %s", more, more > 1 ? "s" : "", rows);
  } else if (suspect->repeats) {
    fg_text_clip(text, FG_LOOP_WORDS, "no number of repeats: it deviates too little");
  } else if (!more) {
    fg_text_clip(text, FG_LOOP_WORDS, "no number of rows that one would measure");
  } else if (*suspect->at) {
    fg_text_clip(text, FG_LOOP_WORDS, "%zu more rows, %s", more, suspect->at);
  } else {
    put_rows(more, "more rows like these", text);
  }
}

static const char *find_suspect_decides(const fg_subject *suspect, char *buffer) {
  fg_loop_suspect_decides(suspect->whole, suspect_of(suspect), buffer);
  return buffer;
}

static const char *find_suspect_size(const fg_subject *suspect, char *buffer) {
  fg_loop_claim_size(suspect->whole, &suspect_of(suspect)->claim, buffer);
  return buffer;
}

static const char *find_suspect_words(const fg_subject *suspect, char *buffer) {
  fg_loop_claim_words(suspect->whole, &suspect_of(suspect)->claim, buffer);
  return buffer;
}

/* Aliases of a suspect that people are told: the first of single effects. */
enum { ALIASES_TOLD = 3 };

static size_t list_aliases(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                           size_t size) {
  char words[2 * FG_LOOP_WORDS];
  size_t told = 0;
  *text = 0;
  for (size_t k = 0; k < claim->aliases && told < ALIASES_TOLD; k++) {
    if (claim->alias[k].sum) continue;
    size_t used = strlen(text);
    fg_loop_alias_words(report, &claim->alias[k], words);
    fg_text_clip(text + used, size - used, "%s%s", told++ ? "; " : "", words);
  }
  return told;
}

static const char *find_suspect_aliases(const fg_subject *suspect, char *buffer) {
  size_t told =
      list_aliases(suspect->whole, &suspect_of(suspect)->claim, buffer, FG_MEMBER_TEXT_MAX);
  return told ? buffer : "–";
}

#define P_COLUMN(rank_, heading_)                                                                  \
  { .rank = (rank_), .heading = (heading_), .digits = 2, .min = 1e-12 }

static const fg_member suspect_rows[] = {
    {FG_TEXT_BY("suspected", find_suspect_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "suspected", .words = true},
     .terminal = {.rank = 1, .heading = "suspected", .words = true}},
    {FG_TEXT_BY("size", find_suspect_size), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "difference, if it is there", .words = true}},
    {FG_TEXT_BY("id", find_suspect_id), .options = FG_MEMBER_NEVER_NULL, .words = "effect"},
    {FG_TEXT("name", fg_loop_suspect, claim.name), .words = "effect with its columns"},
    {FG_TEXTS_BY("coordinates", suspect_coordinate_at), .words = "columns that it acts on"},
    {FG_ARRAY("rows", fg_loop_suspect, claim.candidate.row, claim.candidate.rows,
              &fg_loop_row_members),
     .present = is_of_single_rows, .words = "of wrong or exchanged responses"},
    {FG_TEXT_BY("sentence", fg_loop_find_sentence), .options = FG_MEMBER_NEVER_NULL,
     .words = "effect on the response, if it is there, with U (95 %)"},
    {FG_NUMBER_U("amplitude", fg_loop_suspect, claim.amplitude, claim.amplitude_u),
     .words = "half the range of the effect over the rows"},
    {FG_NUMBER("p_alone", fg_loop_suspect, own_p), .words = "had nothing else been tried",
     .page = P_COLUMN(3, "p alone"), .terminal = P_COLUMN(2, "p alone")},
    {FG_NUMBER("p_value", fg_loop_suspect, claim.p_value),
     .words = "over everything that was tried", .page = P_COLUMN(4, "p of all\nthat was tried"),
     .terminal = P_COLUMN(3, "p of all tried")},
    {FG_ARRAY("alias_class", fg_loop_suspect, claim.alias, claim.aliases, &fg_loop_alias_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_ENDS_BELOW,
     .words = "effects that would look so as well"},
    {FG_TEXT_BY("aliases", find_suspect_aliases), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 5, .heading = "would look the same", .words = true}},
    {FG_COUNT("more_rows", fg_loop_suspect, more_rows), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "to add, that decide with a power of 90 % if the effect is as large as it looks; "
              "null: no number would"},
    {FG_TEXT_BY("decides", find_suspect_decides), .options = FG_MEMBER_NEVER_NULL,
     .words = "these rows and their settings in words",
     .page = {.rank = 6, .heading = "would decide (power 90 %)", .words = true},
     .terminal = {.rank = 4, .heading = "would decide", .words = true}},
};
const fg_members fg_loop_suspect_members = FG_MEMBERS(suspect_rows);

static fg_status append_first(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_suspect *first = &report->result->suspect[0];
  char words[2 * FG_LOOP_WORDS], decides[FG_LOOP_WORDS];
  fg_loop_claim_sentence(report, &first->claim, words);
  FG_TRY(fg_text_append(ctx, text, "Suspected, not proven: %s. ", words));
  FG_TRY(fg_text_append(
      ctx, text,
      "Asked for alone it would have %s; over everything that was tried %s: noise alone would "
      "look like this in %.2g %% of such tables.",
      fg_loop_p_text(first->own_p).text, fg_loop_p_text(first->claim.p_value).text,
      100 * first->claim.p_value));
  if (first->claim.p_value < FG_LOOP_ACCEPT_P)
    FG_TRY(fg_text_append(ctx, text,
                          " It is not proven all the same: it hinges on single rows, or does not "
                          "lower the error of rows that are left out."));
  if (list_aliases(report, &first->claim, words, sizeof words))
    FG_TRY(fg_text_append(ctx, text, " The same could be: %s.", words));
  fg_loop_suspect_decides(report, first, decides);
  bool possible = first->more_rows > 0;
  return fg_text_append(ctx, text, possible ? " What would decide: %s." : " It is decided by %s.",
                        decides);
}

fg_status fg_loop_append_suspects(fg_context *ctx, const fg_loop_report *report, char **text) {
  const fg_loop_result *result = report->result;
  char words[FG_LOOP_WORDS];
  FG_TRY(append_first(ctx, report, text));
  for (size_t i = 1; i < result->suspects; i++) {
    fg_loop_claim_words(report, &result->suspect[i].claim, words);
    FG_TRY(fg_text_append(ctx, text, "%s%s (%s)", i > 1 ? "; " : " Also suspected: ", words,
                          fg_loop_p_text(result->suspect[i].claim.p_value).text));
  }
  return result->suspects > 1 ? fg_text_append(ctx, text, ".") : FG_OK;
}
