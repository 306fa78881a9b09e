/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the report of load-displacement tests. */
#ifndef FG_REPORT_LOAD_TEST_MEMBERS_H
#define FG_REPORT_LOAD_TEST_MEMBERS_H

#include "core/member.h"
#include "foilgauge/load_test.h"

/* Of fg_load_direction, in an fg_load_test: of CSV, terminal and page, too. */
extern const fg_members fg_load_direction_members;

/* Directions of one bearing: of the list {fg_load_bearing, fg_load_test}, whose index is the
 * bearing's. */
fg_member_element fg_load_direction_of_bearing;
fg_subject fg_load_bearing_subject(const fg_load_test *test, size_t bearing);

extern const fg_document fg_load_document;

#endif
