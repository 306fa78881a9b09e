/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of a bump's stiffness side by side: members of reports, tables of pages and terminal.
 */
#ifndef FG_REPORT_STIFFNESS_TABLE_H
#define FG_REPORT_STIFFNESS_TABLE_H

#include "core/member.h"
#include "foilgauge/stiffness.h"
#include "report/stiffness/map.h"

/* A bump by one model. */
typedef struct fg_stiffness_result {
  fg_arch_sensitivity sensitivity; /* first, for its members are columns of the same table */
  double stiffness_n_mm2, per_area_n_mm3, over_arch;
  char reserve[FG_STIFFNESS_WORDS];
  const fg_stiffness_model *model;
  const char *title, *bump; /* of the model; of the bump: "as designed" */
} fg_stiffness_result;

/* A bump by every model: the design's, or one of a lot's mean. */
typedef struct fg_stiffness_case {
  fg_stiffness_result by_model[FG_STIFFNESS_MODELS];
} fg_stiffness_case;

fg_stiffness_case fg_stiffness_case_of(const char *title, const fg_design *design,
                                       const fg_arch *arch, const fg_arch_material *material);

/* Stiffness of the design's bump. */
typedef struct fg_stiffness_of_design {
  const fg_arch_material *material;
  double pitch_mm;
  const char *note;
  fg_stiffness_case bump;
  fg_stiffness_map map;
} fg_stiffness_of_design;

fg_stiffness_of_design fg_stiffness_find_of_design(const fg_design *design,
                                                   const fg_arch_material *material);

/* Members of: fg_stiffness_of_design, of a model (id, formula, source), of an
 * fg_stiffness_result, of an fg_arch_sensitivity. */
extern const fg_members fg_stiffness_design_members, fg_stiffness_model_members,
    fg_stiffness_result_members, fg_sensitivity_members;

/* Writes a table, its columns explained, and the models' formulas, sources and reserves below. */
void fg_html_stiffness_table(FILE *out, const fg_stiffness_case *cases, size_t count);

void fg_text_stiffness_table(FILE *out, const fg_stiffness_case *bump);

#endif
