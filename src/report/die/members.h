/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the die's report. */
#ifndef FG_REPORT_DIE_MEMBERS_H
#define FG_REPORT_DIE_MEMBERS_H

#include "core/member.h"

/* Of fg_die_trace, in an fg_die; of the page's table, too. */
extern const fg_members fg_die_trace_members;
fg_member_element fg_die_trace_at;

extern const fg_document fg_die_document;

#endif
