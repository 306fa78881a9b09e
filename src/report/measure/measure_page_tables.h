/* The tables of a page. */
#ifndef FG_REPORT_MEASURE_MEASURE_PAGE_TABLES_H
#define FG_REPORT_MEASURE_MEASURE_PAGE_TABLES_H

#include "report/measure/measure_page_parts.h"

void fg_html_bump_table(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_html_disc_table(FILE *out, const fg_design *design, const fg_measurement *measurement);
void fg_html_foil_table(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
