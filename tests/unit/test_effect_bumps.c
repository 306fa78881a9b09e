/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The curve of single bumps: its columns are each bump's own, however many bumps there are, and a
 * search tells bumps that were raised by it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "effect_search/policy.h"
#include "effect_search/search.h"
#include "support/foil_rows.h"
#include "support/test.h"

static const fg_effect *curve(void) {
  return fg_effect_find("free.bump.index");
}

/* Rows of one part whose bumps are numbered from `first`. */
static fg_edge_fit make_rows(int first, int count, fg_edge_fit_part *part) {
  enum { PLACES = 41 };
  fg_edge_fit edge_fit = {.parts = part, .part_count = 1};
  *part = (fg_edge_fit_part){.bump_count = (size_t)count};
  part->bumps = calloc((size_t)count, sizeof *part->bumps);
  edge_fit.rows = calloc((size_t)count * PLACES + 1, sizeof *edge_fit.rows);
  for (int b = 0; b < count; b++) {
    part->bumps[b].number = first + b;
    for (int i = 0; i < PLACES; i++)
      edge_fit.rows[edge_fit.row_count++] = (fg_edge_fit_row){
          .bump = first + b, .bump_index = (size_t)b, .phi = 2.0 * i / (PLACES - 1) - 1};
  }
  edge_fit.row_count++; /* a land */
  return edge_fit;
}

static double p4(double u) {
  return (35 * u * u * u * u - 30 * u * u + 3) / 8;
}

static double p3(double u) {
  return (5 * u * u * u - 3 * u) / 2;
}

/* Length of the part of a target that lies outside the space of the columns. */
static double rest(const fg_edge_fit *edge_fit, const double *columns, const double *target) {
  size_t n = edge_fit->row_count;
  double *basis = calloc(n * FG_FIELD_COLUMNS, sizeof *basis), left = 0;
  double *d = calloc(n, sizeof *d);
  size_t rank = 0;
  for (size_t i = 0; i < n; i++)
    d[i] = target[i];
  for (size_t c = 0; c <= FG_FIELD_COLUMNS; c++) {
    double *v = c < FG_FIELD_COLUMNS ? basis + rank * n : d, square = 0;
    for (size_t i = 0; i < n && c < FG_FIELD_COLUMNS; i++)
      v[i] = columns[c * n + i];
    for (int twice = 0; twice < 2; twice++)
      for (size_t k = 0; k < rank; k++) {
        double dot = 0;
        for (size_t i = 0; i < n; i++)
          dot += basis[k * n + i] * v[i];
        for (size_t i = 0; i < n; i++)
          v[i] -= dot * basis[k * n + i];
      }
    for (size_t i = 0; i < n; i++)
      square += v[i] * v[i];
    left = square;
    if (c == FG_FIELD_COLUMNS || square < 1e-12) continue;
    for (size_t i = 0; i < n; i++)
      v[i] /= sqrt(square);
    rank++;
  }
  free(basis);
  free(d);
  return sqrt(left);
}

typedef struct number_case {
  int first, count;
  int bump, every;  /* raised: one, or every so many */
  double lean, max; /* of the P3; what may be left of 1 um */
} number_case;

static void columns_reproduce_moves_of_single_bumps(void **state) {
  (void)state;
  static const number_case cases[] = {
      {1, 9, 4, 0, 1, 1e-9},   {1, 9, 0, 3, 1, 1e-9},  {3, 12, 14, 0, 1, 1e-9},
      {1, 13, 13, 0, 0, 1e-9}, {1, 24, 1, 0, 0, 1e-9}, {1, 24, 0, 2, 0, 1e-9},
      {1, 40, 0, 2, 0, 0.2},   {1, 40, 0, 3, 0, 0.2},  {2, 64, 0, 5, 0, 0.2},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    in_row("cases[%zu]", k);
    const number_case *c = &cases[k];
    fg_edge_fit_part part;
    fg_edge_fit edge_fit = make_rows(c->first, c->count, &part);
    double *columns = calloc(edge_fit.row_count * FG_FIELD_COLUMNS, sizeof *columns);
    double *target = calloc(edge_fit.row_count, sizeof *target), whole = 0;
    assert_int_equal(fg_effect_columns(&edge_fit, curve(), NULL, columns), FG_FIELD_COLUMNS);
    double mean = 0;
    for (size_t i = 0; i < edge_fit.row_count; i++) {
      const fg_edge_fit_row *row = &edge_fit.rows[i];
      bool raised = c->every ? row->bump % c->every == 0 : row->bump == c->bump;
      if (row->bump && raised) target[i] = p4(row->phi) + c->lean * p3(row->phi);
      mean += row->bump ? target[i] * p4(row->phi) : 0;
      whole += target[i] * target[i];
      for (int column = 0; column < FG_FIELD_COLUMNS; column++)
        if (!row->bump)
          assert_float_equal(columns[column * (int)edge_fit.row_count + (int)i], 0, 0);
    }
    if (c->count > FG_FIELD_COLUMNS) { /* what all bumps share is the crown's, not a pattern */
      double square = 0;
      for (size_t i = 0; i < edge_fit.row_count; i++)
        square += edge_fit.rows[i].bump ? pow(p4(edge_fit.rows[i].phi), 2) : 0;
      for (size_t i = 0; i < edge_fit.row_count; i++)
        if (edge_fit.rows[i].bump) target[i] -= mean / square * p4(edge_fit.rows[i].phi);
    }
    double left = rest(&edge_fit, columns, target);
    if (!(left <= c->max * sqrt(whole)))
      fail_msg("case %zu: %g of %g is left", k, left, sqrt(whole));
    free(target);
    free(columns);
    free(edge_fit.rows);
    free(part.bumps);
  }
}

static bool holds(const fg_explanations *explanations, const char *id) {
  for (size_t m = 0; m < explanations->count; m++)
    for (size_t e = 0; e < explanations->candidate_count; e++)
      if ((explanations->each[m].mask >> e & 1) &&
          !strcmp(explanations->candidates[e].kind->id, id))
        return true;
  return false;
}

/* Raised bumps are neither steps nor bumps that all lean, and bumps that are all alike are no
 * single ones. */
static void search_tells_single_bumps(void **state) {
  (void)state;
  for (int every = 1; every <= 3; every++) {
    fg_context ctx = {0};
    fg_explanations explanations;
    foil_rows f;
    foil_rows_open(&f);
    foil_rows_put_noise(&f, 0.03);
    for (size_t i = 0; i < f.edge_fit.row_count; i++) {
      const fg_edge_fit_row *row = &f.edge_fit.rows[i];
      if (row->bump && row->bump % every == 0) f.residual_um[i] += p4(row->phi);
    }
    const fg_search_request request = {.policy = fg_search_policy_of(&f.edge_fit),
                                       .residual_um = f.residual_um,
                                       .jacobian = f.jacobian,
                                       .look = true};
    assert_ok(&ctx, fg_search_find(&ctx, &f.edge_fit, &request, &explanations));
    assert_true(explanations.right);
    assert_int_equal(holds(&explanations, "free.bump.index"), every > 1);
    assert_int_equal(holds(&explanations, "part.bump_crown"), every == 1);
    assert_false(holds(&explanations, "scan.row_step") || holds(&explanations, "scan.column_step"));
    foil_rows_close(&f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(columns_reproduce_moves_of_single_bumps),
      cmocka_unit_test(search_tells_single_bumps),
  };
  return cmocka_run_group_tests_name("effects of single bumps", tests, NULL, NULL);
}
