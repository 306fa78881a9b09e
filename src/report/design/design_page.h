/* A design's page: what follows from it, and the stiffness of its bumps. */
#ifndef FG_REPORT_DESIGN_PAGE_H
#define FG_REPORT_DESIGN_PAGE_H

#include "foilgauge/design.h"
#include "report/stiffness/stiffness_map.h"
#include "report/stiffness/stiffness_table.h"

typedef struct fg_design_page {
  const fg_design *design;
  const fg_nominal *nominal;
  const fg_arch_material *material;
  fg_stiffness_case bump;
} fg_design_page;

/* Of a form that has bumps. */
void fg_design_page_fill(const fg_design *design, const fg_nominal *nominal,
                         const fg_arch_material *material, fg_design_page *page);

void fg_json_design_stiffness(fg_json *json, const fg_design_page *page);
void fg_html_design_page(FILE *out, const fg_design_page *page);

#endif
