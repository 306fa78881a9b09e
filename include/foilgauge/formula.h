/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model formulas as in R, and the model matrix of a formula and a table.
 *
 *     1 + T + D + T:D + T^2        terms; 1 is the constant and may be left out
 *     T*D                          T + D + T:D
 *     (T + D + P)^2                all terms up to two factors
 *     block/run                    block + block:run
 *     T*D - T:D, T - 1             a term, or the constant, taken out
 *     factor(machine), log(t)      numbers as names; log, log10, exp, sqrt, inverse of a number
 *     `time, h`                    a name with other characters than letters, digits, _ and .
 *     error ~ T + D                the response may stand in front
 *
 * Terms are ordered by degree, otherwise as written, as R does; T^2 is the square of T (R needs
 * I(T^2), which is read too) and of degree 2, while T:T is T. A column of words is a factor with
 * treatment contrasts: the first level is the baseline. A factor whose margin is not in the model
 * gets all its levels (Chambers and Hastie 1992, as R's model.matrix).
 */
#ifndef FOILGAUGE_FORMULA_H
#define FOILGAUGE_FORMULA_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_FORMULA_VARIABLES = 40, FG_FORMULA_TERMS = 2000, FG_FORMULA_POWER = 30 };

typedef enum fg_transform {
  FG_TRANSFORM_NONE,
  FG_TRANSFORM_FACTOR, /* factor(name): a column of numbers that are names */
  FG_TRANSFORM_LOG,
  FG_TRANSFORM_LOG10,
  FG_TRANSFORM_EXP,
  FG_TRANSFORM_SQRT,
  FG_TRANSFORM_INVERSE,
} fg_transform;

typedef struct fg_variable {
  char *column; /* the table's column */
  char *name;   /* as written: factor(machine) */
  fg_transform transform;
} fg_variable;

/* A product of variables: power[i] of variable i. */
typedef struct fg_term {
  unsigned char power[FG_FORMULA_VARIABLES];
} fg_term;

typedef struct fg_formula {
  char *response; /* NULL when the formula has none */
  bool constant;
  fg_variable variable[FG_FORMULA_VARIABLES];
  size_t variables;
  fg_term *term; /* without the constant */
  size_t terms, capacity;
} fg_formula;

/* FG_ERR_USAGE with the place in the text. Free with fg_formula_free. */
fg_status fg_formula_parse(fg_context *ctx, const char *text, fg_formula *formula);
void fg_formula_free(fg_formula *formula);

/* "T:D^2"; the caller frees it. */
fg_status fg_formula_term_name(fg_context *ctx, const fg_formula *formula, const fg_term *term,
                               char **name);
/* The whole right side, canonical: "1 + T + D + T:D". The caller frees it. */
fg_status fg_formula_format(fg_context *ctx, const fg_formula *formula, char **text);

#define FG_PART_NUMBER ((size_t)-1)

/* A column of the model is a product of parts: a power of a number, or 1 where a factor is at a
 * level and 0 elsewhere. */
typedef struct fg_part {
  size_t variable;
  size_t level; /* FG_PART_NUMBER for numbers */
  unsigned power;
} fg_part;

typedef struct fg_model_column {
  char *name;  /* "(constant)", "T", "blockB2:T" */
  size_t term; /* index into formula.term; FG_MODEL_CONSTANT */
  fg_part *part;
  size_t parts;
} fg_model_column;

#define FG_MODEL_CONSTANT ((size_t)-1)

/* The model matrix, with the levels and terms that evaluate it at a new setting. */
typedef struct fg_model {
  fg_formula formula; /* terms deduplicated and ordered; owned */
  fg_levels *levels;  /* formula.variables; count 0 where the variable is a number */
  char **term_name;   /* formula.terms */
  fg_model_column *column;
  size_t columns, column_capacity;
  size_t rows;
  fg_extended *matrix; /* columns × rows, column by column */
} fg_model;

/* Largest model that is computed. Its time grows as rows × columns² and columns³ (with 106 bits: 10
 * s for 500 columns, 10 minutes for 2,000), its memory as rows × columns × 32 bytes. An
 * experiment's model has some ten columns; a factor with hundreds of levels is a name of the row.
 */
#define FG_MODEL_COLUMNS_MAX ((size_t)500)
#define FG_MODEL_CELLS_MAX   ((size_t)1 << 26) /* 2 GiB */
#define FG_MODEL_WORK_MAX    1e10              /* rows × columns²: minutes */

/* FG_ERR_DATA for a larger model, with the term that has most of its columns (`widest`). `source`
 * names the table; NULL: "table". */
fg_status fg_model_check_size(fg_context *ctx, const char *source, size_t rows, size_t columns,
                              const char *widest, size_t widest_columns);

/* Builds the matrix. FG_ERR_DATA: it is larger than the limits above, a column is missing, a word
 * among numbers (with its row), a factor with one level, the logarithm of a number that is not
 * positive. FG_ERR_USAGE: no terms at all. Free with fg_model_free. */
fg_status fg_model_build(fg_context *ctx, const fg_table *table, const fg_formula *formula,
                         fg_model *model);
/* One row of the matrix at a new setting. `setting` holds, for every variable of the formula, the
 * value of its table column, or the index of its level; `row` takes model->columns numbers. */
fg_status fg_model_row(fg_context *ctx, const fg_model *model, const double *setting, double *row);
void fg_model_free(fg_model *model);

#ifdef __cplusplus
}
#endif
#endif
