/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/scale_members.h"

#include "core/text.h"

static const char *find_scale_words(const fg_subject *subject, char *buffer) {
  fg_loop_scale_words(subject->whole, buffer);
  return buffer;
}

static const fg_member scale_rows[] = {
    {FG_NUMBER("power", fg_loop_response_scale, power),
     .words =
         "with the largest likelihood (Box and Cox); 1 is the response itself, 0 its logarithm"},
    {FG_RANGE("power_interval_95", fg_loop_response_scale, interval[0], interval[1])},
    {FG_NUMBER("p_value", fg_loop_response_scale, p_value), .words = "of the power 1, alone"},
    {FG_NUMBER("chosen_power", fg_loop_response_scale, chosen),
     .words = "the simplest in the interval"},
    {FG_COUNT("removes", fg_loop_response_scale, removes),
     .words = "claims of scatter, interaction and wrong rows that do not show on that scale"},
    {FG_TEXT_BY("words", find_scale_words), .options = FG_MEMBER_NEVER_NULL},
};
const fg_members fg_loop_scale_members = FG_MEMBERS(scale_rows);

bool fg_loop_tells_scale(const fg_loop_result *result) {
  const fg_loop_response_scale *scale = &result->scale;
  return scale->known && scale->chosen != 1 &&
         (scale->removes || scale->p_value < FG_LOOP_ACCEPT_P);
}

void fg_loop_scale_words(const fg_loop_report *report, char text[FG_LOOP_WORDS]) {
  const fg_loop_response_scale *scale = &report->result->scale;
  char name[FG_LOOP_NAME];
  fg_loop_scale_name(scale->chosen, report->spec->response, name, sizeof name);
  fg_text_clip(text, FG_LOOP_WORDS,
               "scale of the response: %s fits better (power %.2g, %.2g to %.2g; %s alone)%s. "
               "Errors here stay in the unit of %s",
               name, scale->power, scale->interval[0], scale->interval[1],
               fg_loop_p_text(scale->p_value).text,
               !scale->removes       ? ""
               : scale->removes == 1 ? ", and on it one of the claims does not show"
                                     : ", and on it several of the claims do not show",
               report->spec->response);
}
