/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of a bump's stiffness side by side: as JSON, as a table of a page, as text. */
#ifndef FG_REPORT_STIFFNESS_TABLE_H
#define FG_REPORT_STIFFNESS_TABLE_H

#include "core/json_writer.h"
#include "foilgauge/stiffness.h"

/* A bump by every model: the design's, or one of a lot's mean. */
typedef struct fg_stiffness_case {
  const char *title; /* on pages: "as designed" */
  const char *name;  /* in JSON */
  fg_arch arch;
  fg_stiffness_line lines[FG_STIFFNESS_MODELS];
} fg_stiffness_case;

/* Returns the design's bump. */
fg_stiffness_case fg_stiffness_case_of(const fg_design *design, const fg_arch_material *material);

void fg_json_sensitivity(fg_json *json, const char *name, const fg_arch_sensitivity *sensitivity);

/* Writes one member of the case's name: the bump, and its stiffness by this model. */
void fg_json_stiffness_case(fg_json *json, const fg_stiffness_case *bump, int model,
                            double pitch_mm);

/* Writes the members that describe a model. */
void fg_json_stiffness_model(fg_json *json, int model);

/* Writes a table, its columns explained, and the models' formulas, sources and reserves below. */
void fg_html_stiffness_table(FILE *out, const fg_stiffness_case *cases, size_t count,
                             double pitch_mm);

void fg_text_stiffness_table(FILE *out, const fg_stiffness_case *bump, double pitch_mm);

#endif
