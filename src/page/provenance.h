/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a report comes from: the same rows, in the same words, at the end of every page.
 *
 * The date is that of what was measured or read, never that of the writing: the same inputs give
 * the same bytes, today and in a year. */
#ifndef FG_PAGE_PROVENANCE_H
#define FG_PAGE_PROVENANCE_H

#include <stdio.h>

#include "core/date.h"
#include "foilgauge/foil.h"

struct fg_scanner_model;

typedef struct fg_provenance {
  char first[FG_DATE_TEXT], last[FG_DATE_TEXT]; /* of the inputs; "": not known */
  const char *version;                          /* that measured; NULL: this one */
  const fg_design *design;                      /* NULL: none, or these words */
  const char *design_words;
  bool of_scans;    /* model and calibration are said, also that there is none */
  bool calibration; /* of the design is said, without scans */
  const struct fg_scanner_model *model;
  /* In place of what the design says; of lots, whose models may differ, without `of_scans`. */
  const char *calibration_words;
} fg_provenance;

/* Takes a day, "2026-11-20", or one with its time, into first and last; "" is passed over. */
void fg_provenance_take_date(fg_provenance *provenance, const char *date);
/* The same of a file, by its own time. */
void fg_provenance_take_file(fg_provenance *provenance, const char *path);

/* Rows of a list of facts (<dl class="facts">): date, program, design, model, calibration. */
fg_status fg_html_provenance(fg_context *ctx, FILE *out, const fg_provenance *provenance);
/* The same as a section of its own, for a page without such a list. */
fg_status fg_html_provenance_section(fg_context *ctx, FILE *out, const fg_provenance *provenance);

#endif
