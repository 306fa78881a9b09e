/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/gauges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

static const fg_disc *disc_of(const fg_edge_fit *edge_fit, size_t row) {
  return edge_fit->views[edge_fit->rows[row].view].disc;
}

/* Error of one known radius. */
static void fill_gauge(const fg_edge_fit *edge_fit, size_t part, double *column) {
  for (size_t i = 0; i < edge_fit->row_count; i++)
    column[i] = edge_fit->rows[i].part == part;
}

/* Level of the edges, which makes light discs larger and dark ones smaller; returns its standard
 * uncertainty, um. */
static double fill_level(const fg_edge_fit *edge_fit, double *column) {
  double u_mm = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    column[i] = disc_of(edge_fit, i)->bright ? 1 : -1;
    u_mm = fmax(u_mm, disc_of(edge_fit, i)->level_u_mm);
  }
  return 1000 * u_mm;
}

fg_status fg_evidence_add_gauges(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  double *column = NULL;
  if (!edge_fit->known_count || !fg_evidence_has_room(p, edge_fit->part_count + 1)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *column, (void **)&column));
  for (size_t part = 0; part < edge_fit->part_count; part++) {
    if (!(edge_fit->parts[part].known_radius_mm > 0)) continue;
    fill_gauge(edge_fit, part, column);
    fg_evidence_add(p, column);
    s->scatter.gauges++;
  }
  s->scatter.level_um = fill_level(edge_fit, column);
  fg_evidence_add(p, column);
  free(column);
  return FG_OK;
}
