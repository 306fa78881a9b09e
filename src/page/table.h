/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of a page whose columns are members. */
#ifndef FG_PAGE_TABLE_H
#define FG_PAGE_TABLE_H

#include "core/member.h"

/* Writes a table of the members that the page shows, a row per element of the list. A heading's
 * tooltip is the member's words; U stands under its value; `look` of a member gives its cell's
 * class, that of the members the line's. */
void fg_html_table(FILE *out, const fg_members *members, const fg_subject *list,
                   fg_member_element *element);

/* The parts, for a table with rows or columns beside those of members. A heading is open after
 * fg_html_table_begin until fg_html_table_rows: more <th> may follow the members'; a row is open
 * after fg_html_table_row, until its </tr>, which the caller writes. */
void fg_html_table_begin(FILE *out, const fg_member_columns *columns);
void fg_html_table_rows(FILE *out);
void fg_html_table_row(FILE *out, const fg_member_columns *columns, const fg_subject *element);
void fg_html_table_end(FILE *out);

#endif
