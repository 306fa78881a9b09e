/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the reports of forming and of a fit of its constants. */
#ifndef FG_REPORT_FORMING_MEMBERS_H
#define FG_REPORT_FORMING_MEMBERS_H

#include "core/member.h"
#include "report/forming/words.h"

/* Of fg_forming_bump, in an fg_forming; of fg_forming_found and fg_forming_run_fit, in an
 * fg_forming_fit: of the terminal's and the page's tables, too. */
extern const fg_members fg_forming_bump_members, fg_forming_found_members, fg_forming_run_members;
fg_member_element fg_forming_bump_at, fg_forming_found_at, fg_forming_run_at;

/* An input file under the name of its role; its object is NULL without a path. */
extern const fg_members fg_forming_file_members;
fg_subject fg_forming_file_subject(const fg_forming_file *file);

void fg_forming_write_notes(fg_json *json, const char *name,
                            char notes[FG_FORMING_NOTES][FG_FORMING_NOTE], size_t count);
#define FG_FORMING_NOTES_SCHEMA "{\"type\": \"array\", \"items\": {\"type\": \"string\"}}"

extern const fg_document fg_forming_document, fg_forming_fit_document;

#endif
