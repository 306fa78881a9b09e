/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rivals: causes that nobody has named, as fields with a Gaussian prior over a coordinate.
 *
 * A row of the table is a basis and the variances of its coefficients for unit amplitude, one list
 * per length. A named effect must lead all rivals to be found. */
#ifndef FG_EVIDENCE_RIVALS_H
#define FG_EVIDENCE_RIVALS_H

#include "effect/effect.h"

enum { FG_RIVAL_COLUMNS = 128 };

/* One rival on these rows. */
typedef struct fg_rival {
  const char *name;
  fg_effect_coordinate
      coordinate; /* of the free curve that shows it, and the thing moved (NULL: any) */
  const char *moves;
  bool loose; /* of so many numbers that their prior shapes what the rows do not show: it explains a
                 residual, but corrects nothing */
  /* Of the part, and of the edge: columns of one row. */
  size_t (*columns)(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *values);
  /* Of the scanner: displacement at a place, per column. */
  size_t (*glass)(const fg_field_frame *frame, fg_point at, fg_point *d);
  /* Fills the variances of the columns for length i; returns false beyond the last one. */
  bool (*variances)(const fg_edge_fit *edge_fit, size_t i, double *variance);
  /* A rival of its own for every stretch of `stretch` columns: one bump, one harmonic, one map of
   * the glass. NULL: the whole rival. */
  size_t (*stretch)(const fg_edge_fit *edge_fit);
  bool of_last; /* its columns are those of the row before it */
} fg_rival;

/* The rows; NULL-terminated by name. */
extern const fg_rival fg_rivals[];

/* Returns false on discs for rivals of foils: the forms that discs have alike are noise, that of
 * one disc alone is a rival. */
bool fg_rival_shows(const fg_rival *rival, const fg_edge_fit *edge_fit);

/* Fills all columns of one row, um along its normal per unit; returns their number. What moves the
 * glass moves the midline as fg_effect_columns has it. */
size_t fg_rival_columns(const fg_rival *rival, const fg_edge_fit *edge_fit,
                        const fg_edge_fit_row *row, double *values);

/* Returns the free curve that shows a rival in reports, by its coordinate and the thing moved
 * (NULL: any). */
const fg_effect *fg_rival_curve(fg_effect_coordinate coordinate, const char *moves);

#endif
