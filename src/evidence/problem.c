/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/problem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

/* Share of a vector beside the basis, below which it lies in its span. */
#define IN_SPAN 1e-10
/* Error of the edge model, um, which is smooth along the edge: it bounds what evidence can tell
 * (reports/loop_scans.md), and a share of the residual that linear columns leave of large effects.
 */
#define EDGE_ERROR_UM   0.02
#define LINEARITY_SHARE 0.004
/* Variance of the linearisation error over that of the noise, from which a second linearisation is
 * worth its time. */
#define LARGE_SHARE 0.1
/* Error of a coarse strip's edges from place to place, as a share of their blur, for each unit of
 * fg_strip_coarseness above 1: with it nothing is claimed of sound foils at 600 dpi. The shift of a
 * whole line is less (FG_LINE_SHIFT_BLURS of geometry/foil_uncertainty.h). */
#define COARSE_BLURS 0.004
/* Length over which such errors are alike, mm. */
#define ERROR_LENGTH_MM 0.3

/* Bumps of up to six foils; rows of as many. Discs: fewer show their own forms alone. */
enum { BUMPS_MAX = 60, ROWS_MAX = 8000, DISCS_MIN = 3, DISCS_MAX = 40 };

bool fg_evidence_fits(const fg_edge_fit *edge_fit) {
  size_t bumps = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++)
    bumps += edge_fit->parts[p].bump_count;
  if (edge_fit->row_count > ROWS_MAX) return false;
  if (edge_fit->discs)
    return edge_fit->part_count >= DISCS_MIN && edge_fit->part_count <= DISCS_MAX;
  return bumps && bumps <= BUMPS_MAX;
}

/* Mean distance of neighbouring rows in use along their arcs, mm. */
static double row_spacing_mm(const fg_evidence_problem *p) {
  double sum = 0;
  size_t count = 0;
  for (size_t k = 1; k < p->rows; k++) {
    const fg_edge_fit_row *a = &p->edge_fit->rows[p->row[k - 1]],
                          *b = &p->edge_fit->rows[p->row[k]];
    double apart = fabs(a->s_mm - b->s_mm);
    if (a->view != b->view || a->group != b->group || apart > ERROR_LENGTH_MM) continue;
    sum += apart;
    count++;
  }
  return count ? sum / (double)count : ERROR_LENGTH_MM;
}

/* Error of the edge model on the coarsest view of a foil, um; 0: every strip has a plateau. */
static double find_coarse_error_um(const fg_edge_fit *edge_fit) {
  double largest = 0;
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_foil *foil = edge_fit->views[v].foil;
    if (!foil) continue;
    double coarser = fg_strip_coarseness(&foil->strip) - 1;
    if (coarser > 0)
      largest = fmax(largest, COARSE_BLURS * coarser * fg_strip_blur_um(&foil->strip));
  }
  return largest;
}

static void find_noise_um(fg_evidence_problem *p, const double *residual_um) {
  const fg_scatter *s = &p->edge_fit->scatter;
  double square = 0, weight = 0;
  for (size_t k = 0; k < p->rows; k++) {
    const fg_edge_fit_row *row = &p->edge_fit->rows[p->row[k]];
    square += row->weight * residual_um[p->row[k]] * residual_um[p->row[k]];
    weight += row->weight;
  }
  double linear2 = LINEARITY_SHARE * LINEARITY_SHARE * (weight > 0 ? square / weight : 0);
  double alike = fmax(1, sqrt(M_PI) * ERROR_LENGTH_MM / row_spacing_mm(p));
  double integral = s->share > 0 ? s->integral : 1;
  double coarse_um = find_coarse_error_um(p->edge_fit);
  p->error_um = sqrt(EDGE_ERROR_UM * EDGE_ERROR_UM + coarse_um * coarse_um + linear2);
  double error2 = p->error_um * p->error_um * alike;
  p->noise_um = sqrt(s->row_um * s->row_um * integral * fmax(1, s->swell) + error2);
  p->large = linear2 * alike > LARGE_SHARE * p->noise_um * p->noise_um;
}

static void whiten_rows(const fg_evidence_problem *p, const double *values, double *white,
                        double *out) {
  for (size_t i = 0; i < p->edge_fit->row_count; i++)
    white[i] = fg_edge_fit_root_weight(&p->edge_fit->rows[i]) * values[i] / p->noise_um;
  fg_whitening_apply(&p->whitening, white);
  for (size_t k = 0; k < p->rows; k++)
    out[k] = white[p->row[k]];
}

static fg_evidence_span span_of(const double *values, size_t rows) {
  fg_evidence_span span = {0, rows};
  while (span.first < rows && values[span.first] == 0)
    span.first++;
  while (span.last > span.first && values[span.last - 1] == 0)
    span.last--;
  return span;
}

fg_evidence_span fg_evidence_overlap(fg_evidence_span a, fg_evidence_span b) {
  fg_evidence_span both = {a.first > b.first ? a.first : b.first,
                           a.last < b.last ? a.last : b.last};
  if (both.last < both.first) both.last = both.first;
  return both;
}

double fg_evidence_dot(const double *a, fg_evidence_span of_a, const double *b,
                       fg_evidence_span of_b) {
  const fg_evidence_span both = fg_evidence_overlap(of_a, of_b);
  return fg_dot_in_lanes(a + both.first, b + both.first, both.last - both.first);
}

/* Removes the flat directions; `along` gets the parts along them. */
static void project_flat_out(const fg_evidence_problem *p, double *v, double *along) {
  memset(along, 0, p->rank * sizeof *along);
  for (int twice = 0; twice < 2; twice++)
    for (size_t k = 0; k < p->rank; k++) {
      const double *b = p->basis + k * p->rows;
      const fg_evidence_span span = p->basis_span[k];
      double d = fg_dot_in_lanes(b + span.first, v + span.first, span.last - span.first);
      along[k] += d;
      fg_subtract_share(v + span.first, d, b + span.first, span.last - span.first);
    }
}

/* Extends the basis by a direction of the geometry, unless it lies in its span. */
static void add_direction(fg_evidence_problem *p, const double *direction, const double *jacobian,
                          double *column) {
  size_t parameters = p->edge_fit->parameters, rows = p->edge_fit->row_count;
  memset(column, 0, rows * sizeof *column);
  for (size_t a = 0; a < parameters; a++)
    for (size_t i = 0; direction[a] != 0 && i < rows; i++)
      column[i] += direction[a] * jacobian[a * rows + i];
  double *to = p->basis + p->rank * p->rows, *numbers = p->directions + p->rank * parameters;
  whiten_rows(p, column, p->white, to);
  double whole = fg_dot_in_lanes(to, to, p->rows), *along = p->residual_along;
  project_flat_out(p, to, along);
  double left = fg_dot_in_lanes(to, to, p->rows);
  if (!(left > IN_SPAN * whole)) return;
  memcpy(numbers, direction, parameters * sizeof *numbers);
  for (size_t k = 0; k < p->rank; k++)
    for (size_t a = 0; a < parameters; a++)
      numbers[a] -= along[k] * p->directions[k * parameters + a];
  for (size_t i = 0; i < p->rows; i++)
    to[i] /= sqrt(left);
  for (size_t a = 0; a < parameters; a++)
    numbers[a] /= sqrt(left);
  p->basis_span[p->rank] = span_of(to, p->rows);
  p->rank++;
}

/* Flat directions: of each part of several bumps the means of X, beta and R and their linear
 * trends over the bumps' numbers; every other parameter alone. */
static fg_status find_flat_directions(fg_context *ctx, fg_evidence_problem *p,
                                      const double *jacobian) {
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t parameters = edge_fit->parameters, at = 0;
  double *direction = NULL;
  FG_TRY(fg_memory_allocate(ctx, parameters + edge_fit->row_count, sizeof *direction,
                            (void **)&direction));
  double *column = direction + parameters;
  for (size_t part = 0; part < edge_fit->part_count; part++) {
    size_t bumps = edge_fit->parts[part].bump_count;
    int middle = bumps ? edge_fit->parts[part].bumps[bumps / 2].number : 0;
    direction[at] = 1;
    if (!(edge_fit->parts[part].known_radius_mm > 0)) add_direction(p, direction, jacobian, column);
    direction[at] = 0;
    for (size_t k = 0; bumps && k < 3; k++)
      for (int trend = 0; trend < 2; trend++) {
        for (size_t b = 0; b < bumps; b++)
          direction[at + 1 + 3 * b + k] =
              trend ? (double)(edge_fit->parts[part].bumps[b].number - middle) / (double)bumps : 1;
        add_direction(p, direction, jacobian, column);
        memset(direction, 0, parameters * sizeof *direction);
      }
    at += 1 + 3 * bumps;
  }
  for (; at < parameters; at++) { /* poses */
    direction[at] = 1;
    add_direction(p, direction, jacobian, column);
    direction[at] = 0;
  }
  free(direction);
  return FG_OK;
}

static fg_status allocate_problem(fg_context *ctx, fg_evidence_problem *p) {
  size_t rows = p->edge_fit->row_count, parameters = p->edge_fit->parameters;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *p->row, (void **)&p->row));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *p->white, (void **)&p->white));
  FG_TRY(fg_memory_allocate(ctx, rows * parameters, sizeof *p->basis, (void **)&p->basis));
  FG_TRY(fg_memory_allocate(ctx, parameters * parameters, sizeof *p->directions,
                            (void **)&p->directions));
  FG_TRY(fg_memory_allocate(ctx, parameters, sizeof *p->basis_span, (void **)&p->basis_span));
  FG_TRY(fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS, sizeof *p->span, (void **)&p->span));
  FG_TRY(
      fg_memory_allocate(ctx, parameters, sizeof *p->residual_along, (void **)&p->residual_along));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *p->residual, (void **)&p->residual));
  FG_TRY(
      fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS * rows, sizeof *p->values, (void **)&p->values));
  FG_TRY(fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS * parameters, sizeof *p->along,
                            (void **)&p->along));
  FG_TRY(fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS, sizeof *p->right, (void **)&p->right));
  FG_TRY(fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS, FG_EVIDENCE_NEAR * sizeof *p->near,
                            (void **)&p->near));
  return fg_memory_allocate(ctx, FG_EVIDENCE_COLUMNS, sizeof *p->gram, (void **)&p->gram);
}

fg_status fg_evidence_open(fg_context *ctx, const fg_edge_fit *edge_fit, const double *residual_um,
                           const double *jacobian, fg_evidence_problem *p) {
  *p = (fg_evidence_problem){.edge_fit = edge_fit};
  fg_status status = FG_OK;
  FG_TRY_EXIT(allocate_problem(ctx, p));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    if (edge_fit->rows[i].weight > 0 && !edge_fit->views[edge_fit->rows[i].view].held_out)
      p->row[p->rows++] = i;
  FG_TRY_EXIT(fg_whitening_open(ctx, edge_fit, &p->whitening));
  find_noise_um(p, residual_um);
  FG_TRY_EXIT(find_flat_directions(ctx, p, jacobian));
  whiten_rows(p, residual_um, p->white, p->residual);
  project_flat_out(p, p->residual, p->residual_along);
exit:
  if (status != FG_OK) fg_evidence_close(p);
  return status;
}

void fg_evidence_rescale(fg_evidence_problem *p, double noise_um) {
  double by = p->noise_um / noise_um;
  for (size_t i = 0; i < p->count * p->rows; i++)
    p->values[i] *= by;
  for (size_t i = 0; i < p->count * p->rank; i++)
    p->along[i] *= by;
  for (size_t i = 0; i < p->rows; i++)
    p->residual[i] *= by;
  for (size_t k = 0; k < p->rank; k++)
    p->residual_along[k] *= by;
  for (size_t i = 0; i < p->rank * p->edge_fit->parameters; i++)
    p->directions[i] /= by;
  for (size_t c = 0; c < p->count; c++) {
    p->right[c] *= by * by;
    for (size_t k = 0; p->gram[c] && k < FG_EVIDENCE_COLUMNS; k++)
      p->gram[c][k] *= by * by;
    for (size_t k = 0; k < FG_EVIDENCE_NEAR; k++)
      p->near[c * FG_EVIDENCE_NEAR + k] *= by * by;
  }
  p->noise_um = noise_um;
}

void fg_evidence_close(fg_evidence_problem *p) {
  for (size_t c = 0; p->gram && c < p->count; c++)
    free(p->gram[c]);
  fg_whitening_close(&p->whitening);
  free(p->row);
  free(p->white);
  free(p->basis);
  free(p->directions);
  free(p->residual_along);
  free(p->residual);
  free(p->values);
  free(p->along);
  free(p->basis_span);
  free(p->span);
  free(p->right);
  free(p->near);
  free(p->gram);
  *p = (fg_evidence_problem){.edge_fit = NULL};
}

void fg_evidence_make(const fg_evidence_problem *p, const double *values, double *white,
                      fg_evidence_column *column) {
  whiten_rows(p, values, white, column->values);
  project_flat_out(p, column->values, column->along);
  column->span = span_of(column->values, p->rows);
  column->right = fg_dot_in_lanes(column->values, p->residual, p->rows);
}

static size_t note_column(fg_evidence_problem *p, size_t at, const fg_evidence_column *column) {
  p->span[at] = column->span;
  p->right[at] = column->right;
  for (size_t k = 0; k < FG_EVIDENCE_NEAR; k++)
    p->near[at * FG_EVIDENCE_NEAR + k] = NAN;
  return at;
}

void fg_evidence_put(fg_evidence_problem *p, size_t at, const fg_evidence_column *column) {
  memcpy(p->values + at * p->rows, column->values, p->rows * sizeof *p->values);
  memcpy(p->along + at * p->rank, column->along, p->rank * sizeof *p->along);
  note_column(p, at, column);
}

size_t fg_evidence_add(fg_evidence_problem *p, const double *values) {
  fg_evidence_column column = {.values = p->values + p->count * p->rows,
                               .along = p->along + p->count * p->rank};
  fg_evidence_make(p, values, p->white, &column);
  return note_column(p, p->count++, &column);
}

void fg_evidence_put_back(fg_evidence_problem *p, size_t column, double amplitude) {
  const double *values = p->values + column * p->rows;
  for (size_t i = 0; i < p->rows; i++)
    p->residual[i] -= amplitude * values[i];
  for (size_t c = 0; c < p->count; c++)
    p->right[c] = fg_dot_in_lanes(p->values + c * p->rows, p->residual, p->rows);
}
