/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FG_REPORT_SCANNER_CHANGE_MEMBERS_H
#define FG_REPORT_SCANNER_CHANGE_MEMBERS_H

#include "core/member.h"
#include "foilgauge/scanner_change.h"

extern const fg_members fg_scanner_number_members;
fg_member_element fg_scanner_change_find_number; /* whole: the change */

extern const fg_document fg_scanner_change_document;

#endif
