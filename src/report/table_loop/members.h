/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Documents of the loop on tables. */
#ifndef FG_REPORT_TABLE_LOOP_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_MEMBERS_H

#include "core/member.h"

extern const fg_document fg_loop_document, fg_loop_model_document;

#endif
