/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of traceability, of the design that a report was made with. */
#include "foilgauge/traceability.h"

#include <string.h>

#include "report/design/members.h"

static const fg_design *traced_design(const fg_subject *subject) {
  return subject->object;
}

static int find_traceability_state(const fg_subject *subject) {
  return (int)fg_design_traceability(traced_design(subject));
}

#define FACT(field)                                                                                \
  static const char *find_artefact_##field(const fg_subject *subject, char *buffer) {              \
    const fg_artefact artefact = fg_design_traced_to(traced_design(subject));                      \
    strcpy(buffer, artefact.field);                                                                \
    return buffer[0] ? buffer : NULL;                                                              \
  }
FACT(name)
FACT(certificate)
FACT(date)
FACT(due)

static const char *find_not_needed_reason(const fg_subject *subject, char *buffer) {
  const char *reason = traced_design(subject)->calibration.not_needed;
  (void)buffer;
  return reason[0] ? reason : NULL;
}

static const fg_member traceability_rows[] = {
    {FG_WORD_BY("state", find_traceability_state, fg_traceability_words),
     .options = FG_MEMBER_NEVER_NULL,
     .words = "none: nothing is known of the scanner's scale, and no value is judged but for a "
              "reason; stated: a number of the user; plate: an artefact with its certificate"},
    {FG_TEXT_BY("artefact", find_artefact_name), .words = "its name"},
    {FG_TEXT_BY("certificate", find_artefact_certificate),
     .words = "its number, or the user's words"},
    {FG_TEXT_BY("date", find_artefact_date), .words = "of the certificate"},
    {FG_TEXT_BY("due", find_artefact_due), .words = "the last day that it holds"},
    {FG_TEXT_BY("not_needed", find_not_needed_reason),
     .words = "why values are judged without any"},
};
const fg_members fg_traceability_members = {
    .rows = traceability_rows,
    .count = sizeof traceability_rows / sizeof *traceability_rows,
    .definition = "traceability",
    .file = "measure",
};
