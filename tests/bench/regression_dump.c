/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints everything that a regression of `y` in DATA.csv on FORMULA computes, one number a line,
 * for differential_r.sh. */
#include <stdio.h>
#include <stdlib.h>

#include "foilgauge/regression.h"

static char *read_file(const char *path, size_t *length) {
  FILE *file = fopen(path, "rb");
  char *text = malloc(1u << 20);
  if (!file || !text) exit(1);
  *length = fread(text, 1, 1u << 20, file);
  fclose(file);
  return text;
}

/* R's anova leaves out terms without freedom. */
static void print_rows(const char *kind, const fg_anova_row *rows, size_t count) {
  for (size_t i = 0; i < count; i++) {
    if (!rows[i].dof) continue;
    printf("%s_ss %.17g\n%s_df %zu\n%s_f %.17g\n%s_p %.17g\n", kind, rows[i].sum_of_squares, kind,
           rows[i].dof, kind, rows[i].f, kind, rows[i].p_value);
  }
}

static void print_vector(const char *name, const double *values, size_t count) {
  for (size_t i = 0; i < count; i++)
    printf("%s %.17g\n", name, values[i]);
}

static void print_regression(const fg_regression *r) {
  for (size_t i = 0; i < r->columns; i++) {
    const fg_coefficient *c = &r->coefficient[i];
    printf("coef %.17g\nse %.17g\nt %.17g\np %.17g\nlow %.17g\nhigh %.17g\n", c->estimate,
           c->standard_error, c->t, c->p_value, c->low, c->high);
  }
  printf("rank %zu\nrss %.17g\nsigma %.17g\nr2 %.17g\nadj %.17g\nf %.17g\npress %.17g\n", r->rank,
         r->residual_ss, r->residual_sd, r->r2, r->adjusted_r2, r->model_f, r->press);
  print_rows("seq", r->sequential, r->terms);
  print_vector("fitted", r->fitted, r->rows);
  print_vector("hat", r->leverage, r->rows);
  print_vector("rstandard", r->internal, r->rows);
  print_vector("rstudent", r->external, r->rows);
  print_vector("cook", r->cook, r->rows);
}

int main(int argc, char **argv) {
  fg_context ctx = {0};
  fg_table table;
  fg_model model;
  fg_regression regression;
  size_t length = 0;
  if (argc != 3) return 64;
  char *text = read_file(argv[1], &length);
  if (fg_table_parse(&ctx, argv[1], text, length, &table) != FG_OK ||
      fg_regression_analyse(&ctx, &table, argv[2], "y", NULL, &model, &regression) != FG_OK) {
    fprintf(stderr, "%s\n", ctx.message);
    return 65;
  }
  print_regression(&regression);
  fg_regression_free(&regression);
  fg_model_free(&model);
  fg_table_free(&table);
  free(text);
  return 0;
}
