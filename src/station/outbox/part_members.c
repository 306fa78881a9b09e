/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part as JSON. */
#include "report/measure/members.h"
#include "report/verdict_members.h"
#include "station/outbox/part.h"

static const char *const event_words[] = {FG_EVENT_MEASURED, FG_EVENT_CORRECTED, FG_EVENT_DISPOSED,
                                          NULL};
static const char *const disposition_words[] = {"scrap", "rework", "concession", "again", NULL};
static const char *const of_words[] = {"foil", "bump", "beam", NULL};

static const fg_stored_foil *stored_of(const fg_subject *subject) {
  return ((const fg_part *)subject->object)->stored;
}

#define STORED_TEXT(field)                                                                         \
  static const char *find_##field(const fg_subject *subject, char *buffer) {                       \
    (void)buffer;                                                                                  \
    return stored_of(subject)->field;                                                              \
  }
STORED_TEXT(verdict)
STORED_TEXT(withheld)
STORED_TEXT(path)
STORED_TEXT(sha256)
STORED_TEXT(program)

static const char *find_reason(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return stored_of(subject)->reasons[0] ? stored_of(subject)->reasons : NULL;
}

static const char *find_problem(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return stored_of(subject)->problem;
}

static bool has_problem(const fg_subject *subject) {
  return !stored_of(subject)->readable;
}

static double find_foil_number(const fg_subject *subject) {
  return stored_of(subject)->number;
}

static fg_subject find_disposition(const fg_subject *subject) {
  const fg_part *part = subject->object;
  return (fg_subject){.object = part->disposed ? &part->disposition : NULL};
}

static const fg_member disposition_rows[] = {
    {FG_TEXT("kind", fg_part_disposition, kind), .choices = disposition_words},
    {FG_TEXT("reason", fg_part_disposition, reason), .words = "a code of the recipe"},
    {FG_TEXT("note", fg_part_disposition, note)},
    {FG_TEXT("by", fg_part_disposition, by)},
    {FG_TEXT("at", fg_part_disposition, at)},
};
static const fg_members disposition_members = FG_MEMBERS(disposition_rows);

static const fg_member value_rows[] = {
    {FG_STRING("of", fg_part_value, of), .choices = of_words, .options = FG_MEMBER_NEVER_NULL},
    {FG_INTEGER("number", fg_part_value, number), .words = "of the bump or beam; 0: the foil"},
    {FG_STRING("name", fg_part_value, name), .options = FG_MEMBER_NEVER_NULL,
     .words = "as in every report"},
    {FG_STRING("unit", fg_part_value, unit), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("value", fg_part_value, value)},
    {FG_NUMBER("u", fg_part_value, u), .words = "standard uncertainty"},
};
static const fg_members value_members = FG_MEMBERS(value_rows);

static const fg_member part_rows[] = {
    {FG_HEAD("foilgauge/part/1")},
    {FG_TEXT("key", fg_part, key),
     .words =
         "of the event, the same in every attempt: a receiver that has it already has the part"},
    {FG_TEXT("source", fg_part, source), .words = "identity of the station's database"},
    {FG_COUNT("event", fg_part, event), .words = "number of the event in the database; 0: none"},
    {FG_TEXT("kind", fg_part, kind), .choices = event_words},
    {FG_TEXT("at", fg_part, at), .words = "time of the event, UTC"},
    {FG_TEXT("station", fg_part, station)},
    {FG_COUNT("foil", fg_part, foil),
     .words = "number of the foil in the database: of events of one foil the highest is in force"},
    {FG_TEXT("serial", fg_part, serial)},
    {FG_TEXT("lot", fg_part, lot)},
    {FG_TEXT("order", fg_part, order)},
    {FG_TEXT("die", fg_part, die)},
    {FG_TEXT("coil", fg_part, coil)},
    {FG_TEXT("oven", fg_part, oven)},
    {FG_TEXT("scanner", fg_part, scanner)},
    {FG_TEXT("operator", fg_part, operator_name)},
    {FG_TEXT_BY("verdict", find_verdict), .choices = fg_verdict_words,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("withheld", find_withheld),
     .words = "why the verdict does not hold: the scanner's check was due"},
    {FG_TEXT_BY("reason", find_reason), .words = "why it did not pass, where no value tells"},
    {FG_PART("disposition", find_disposition, &disposition_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NULLABLE, .words = "null: none yet"},
    {FG_TEXT("measured_at", fg_part, measured_at), .words = "UTC"},
    {FG_TEXT_BY("scan", find_path), .options = FG_MEMBER_NEVER_NULL,
     .words = "file in the station's folder"},
    {FG_TEXT_BY("scan_sha256", find_sha256), .pattern = FG_SHA256_PATTERN,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT_BY("foil_of_scan", find_foil_number), .words = "reading order in the scan"},
    {FG_TEXT_BY("measured_by", find_program), .options = FG_MEMBER_NEVER_NULL,
     .words = "version of foilgauge"},
    {FG_TEXT_BY("problem", find_problem), .present = has_problem, .options = FG_MEMBER_NEVER_NULL,
     .words = "why there are no values"},
    {FG_JUDGEMENTS(fg_part, decision), .words = FG_JUDGEMENTS_WORDS},
    {FG_LIST("values", fg_part, values, value_count, &value_members), .options = FG_MEMBER_ON_LINE},
};
static const fg_members part_members = FG_MEMBERS(part_rows);

const fg_document fg_part_document = {
    .file = "part",
    .title = "foilgauge part",
    .description = "A foil as a station passes it on when it is measured, corrected or disposed.",
    .made_by = "a recipe's `pass_on`, and `foilgauge station --hub`",
    .members = &part_members,
};
