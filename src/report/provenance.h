/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Provenance of a report: the same rows, in the same words, at the end of every page. The date
 * is that of the inputs, never that of the writing: the same inputs give the same bytes, today
 * and in a year. */
#ifndef FG_REPORT_PROVENANCE_H
#define FG_REPORT_PROVENANCE_H

#include <stdio.h>

#include "core/date.h"
#include "foilgauge/foil.h"

struct fg_scanner_model;

typedef struct fg_provenance {
  /* Dates of the inputs. "": not known; without scans, as of a film of a design, no row then. */
  char first[FG_DATE_TEXT], last[FG_DATE_TEXT];
  const char *version;                          /* of the program that measured; NULL: this one */
  const fg_design *design;                      /* NULL: none, or these words */
  const char *design_words;
  bool of_scans;    /* model and calibration are stated, also when there is none */
  bool calibration; /* the design's is stated, without scans */
  const struct fg_scanner_model *model;
  /* In place of the design's calibration; for lots, whose models may differ, without `of_scans`. */
  const char *calibration_words;
} fg_provenance;

/* Widens first and last by a day, "2026-11-20", with or without its time; "" is ignored. */
void fg_provenance_include_date(fg_provenance *provenance, const char *date);
/* Widens first and last by the file's modification time. */
void fg_provenance_include_file(fg_provenance *provenance, const char *path);

/* Writes rows of a list of facts (<dl class="facts">): date, program, design, model,
 * calibration. */
fg_status fg_html_provenance(fg_context *ctx, FILE *out, const fg_provenance *provenance);
/* Writes these rows as a section of its own, for a page without such a list. */
fg_status fg_html_provenance_section(fg_context *ctx, FILE *out, const fg_provenance *provenance);

#endif
