/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh, cases and states: their memory. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "film/film.h"
#include "foilgauge/memory.h"

static const double full_turn = 2 * 3.14159265358979323846;

size_t fg_film_columns(const fg_film_mesh *mesh) {
  return mesh->ring ? mesh->cells : mesh->pads * (mesh->cells + 1);
}

double fg_film_angle_rad(const fg_film_mesh *mesh, size_t column) {
  double step = mesh->arc_rad / (double)mesh->cells;
  if (mesh->ring) return mesh->start_rad + step * (double)column;
  size_t pad = column / (mesh->cells + 1), node = column % (mesh->cells + 1);
  return mesh->start_rad + full_turn * (double)pad / (double)mesh->pads + step * (double)node;
}

static fg_status allocate_numbers(fg_context *ctx, size_t count, double **numbers) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
  *numbers = block;
  return FG_OK;
}

fg_status fg_film_case_open(fg_context *ctx, size_t columns, fg_film_case *at) {
  *at = (fg_film_case){0};
  fg_status status = allocate_numbers(ctx, columns, &at->clearance);
  if (status == FG_OK) status = allocate_numbers(ctx, columns, &at->spring);
  if (status == FG_OK) status = allocate_numbers(ctx, columns, &at->yield);
  if (status != FG_OK) fg_film_case_close(at);
  return status;
}

void fg_film_case_copy(const fg_film_case *from, size_t columns, fg_film_case *to) {
  fg_film_case own = *to;
  *to = *from;
  to->clearance = memcpy(own.clearance, from->clearance, columns * sizeof(double));
  to->spring = memcpy(own.spring, from->spring, columns * sizeof(double));
  to->yield = memcpy(own.yield, from->yield, columns * sizeof(double));
}

void fg_film_case_close(fg_film_case *at) {
  free(at->clearance);
  free(at->spring);
  free(at->yield);
  *at = (fg_film_case){0};
}

fg_status fg_film_state_open(fg_context *ctx, const fg_film *film, fg_film_state *state) {
  *state = (fg_film_state){0};
  fg_status status = allocate_numbers(ctx, film->columns * film->nodes, &state->pressure);
  if (status == FG_OK) status = allocate_numbers(ctx, film->columns, &state->deflection);
  if (status != FG_OK) fg_film_state_close(state);
  return status;
}

void fg_film_state_copy(const fg_film *film, const fg_film_state *from, fg_film_state *to) {
  memcpy(to->pressure, from->pressure, film->columns * film->nodes * sizeof(double));
  memcpy(to->deflection, from->deflection, film->columns * sizeof(double));
  memcpy(to->place, from->place, sizeof to->place);
}

void fg_film_state_close(fg_film_state *state) {
  free(state->pressure);
  free(state->deflection);
  *state = (fg_film_state){0};
}

/* Numbers the unknowns: the pressures of a column that is no edge, then its deflection. */
static int number_unknowns(fg_film *film) {
  int next = 0;
  for (size_t i = 0; i < film->columns; i++) {
    double angle = fg_film_angle_rad(&film->mesh, i);
    size_t node = i % (film->mesh.cells + 1);
    film->cosine[i] = cos(angle);
    film->sine[i] = sin(angle);
    film->edge[i] = !film->mesh.ring && (node == 0 || node == film->mesh.cells);
    film->base[i] = next;
    next += film->edge[i] ? 1 : (int)film->mesh.axial + 1;
  }
  for (size_t j = 0; j < film->nodes; j++)
    film->weight[j] = film->step_z * (j == 0 || j == film->mesh.axial ? 0.5 : 1);
  return next;
}

static fg_status allocate_columns(fg_context *ctx, fg_film *film) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, film->columns, sizeof(int), &block));
  film->base = block;
  FG_TRY(fg_memory_allocate(ctx, film->columns, sizeof(bool), &block));
  film->edge = block;
  FG_TRY(allocate_numbers(ctx, film->columns, &film->cosine));
  FG_TRY(allocate_numbers(ctx, film->columns, &film->sine));
  FG_TRY(allocate_numbers(ctx, film->nodes, &film->weight));
  FG_TRY(fg_film_state_open(ctx, film, &film->trial));
  return fg_film_state_open(ctx, film, &film->kept);
}

static fg_status allocate_system(fg_context *ctx, fg_film *film) {
  size_t size = (size_t)film->sparse.size, entries = film->sparse.entries;
  double **const by_entry[] = {&film->matrix, &film->time, &film->lossy};
  void *block;
  for (size_t i = 0; i < 3; i++)
    FG_TRY(allocate_numbers(ctx, entries, by_entry[i]));
  FG_TRY(allocate_numbers(ctx, 3 * size, &film->step_of));
  FG_TRY(fg_memory_allocate(ctx, entries, sizeof(double complex), &block));
  film->whirl = block;
  FG_TRY(fg_memory_allocate(ctx, 2 * size, sizeof(double complex), &block));
  film->response = block;
  return FG_OK;
}

static fg_status allocate_residual(fg_context *ctx, fg_film *film) {
  double **const by_unknown[] = {&film->residual, &film->shift[0], &film->shift[1],
                                 &film->shift_time[0], &film->shift_time[1]};
  for (size_t i = 0; i < 5; i++)
    FG_TRY(allocate_numbers(ctx, (size_t)film->sparse.size, by_unknown[i]));
  return FG_OK;
}

static fg_status open_parts(fg_context *ctx, bool bends, fg_film *film) {
  fg_film_case any = {0};
  FG_TRY(allocate_columns(ctx, film));
  fg_sparse_begin(&film->sparse, number_unknowns(film));
  FG_TRY(allocate_residual(ctx, film));
  FG_TRY(fg_film_case_open(ctx, film->columns, &any));
  any.bending = bends;
  fg_film_assemble(ctx, film, &any, &film->trial);
  fg_film_case_close(&any);
  FG_TRY(fg_sparse_finish(ctx, &film->sparse));
  return allocate_system(ctx, film);
}

fg_status fg_film_open(fg_context *ctx, const fg_film_mesh *mesh, bool bends, fg_film *film) {
  *film = (fg_film){.mesh = *mesh,
                    .columns = fg_film_columns(mesh),
                    .nodes = mesh->axial + 1,
                    .step = mesh->arc_rad / (double)mesh->cells,
                    .step_z = mesh->half_length / (double)mesh->axial};
  fg_status status = open_parts(ctx, bends, film);
  if (status != FG_OK) fg_film_close(film);
  return status;
}

void fg_film_close(fg_film *film) {
  double *const numbers[] = {film->cosine,   film->sine,          film->weight,
                             film->matrix,   film->time,          film->lossy,
                             film->residual, film->shift[0],      film->shift[1],
                             film->step_of,  film->shift_time[0], film->shift_time[1]};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    free(numbers[i]);
  free(film->base);
  free(film->edge);
  free(film->whirl);
  free(film->response);
  fg_film_state_close(&film->trial);
  fg_film_state_close(&film->kept);
  fg_sparse_free(&film->sparse);
  *film = (fg_film){0};
}
