/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws of a lot from the posterior: the process with its die, and single foils about it. */
#ifndef FG_COMPENSATION_DRAWS_H
#define FG_COMPENSATION_DRAWS_H

#include <stdint.h>

#include "compensation/sets.h"
#include "compensation/springback.h"

/* One drawn process: logarithms of the formed sizes by quantity and place, and the sizes of the
 * scatter about them. */
typedef struct fg_drawn_process {
  double log_size[FG_FORMED][FG_COMPENSATION_BUMPS];
  fg_springback_sizes sizes[FG_FORMED];
} fg_drawn_process;

/* Dimensions of one foil, or of a mean of foils. */
typedef struct fg_drawn_foil {
  double overall_radius_mm, pitch_deg;
  double radius_mm[FG_COMPENSATION_BUMPS], angle_deg[FG_COMPENSATION_BUMPS],
      height_mm[FG_COMPENSATION_BUMPS];
} fg_drawn_foil;

/* Source of draws: laws, the die, and foils whose deviations stand for the scatter. */
typedef struct fg_drawer {
  const struct fg_formed_laws *laws;
  const fg_die_dimensions *die;
  fg_formed_foil *deviation; /* of foils from their sets' means, widened by n - 1; owned */
  size_t deviations;
  uint64_t state;
} fg_drawer;

fg_status fg_drawer_begin(fg_context *ctx, const struct fg_formed_laws *laws,
                          const fg_die_dimensions *die, const fg_formed_sets *sets,
                          fg_drawer *drawer);
void fg_drawer_end(fg_drawer *drawer);

void fg_draw_process(fg_drawer *drawer, fg_drawn_process *process);
/* Derives the process's own foil: no scatter. */
void fg_process_foil(const fg_drawer *drawer, const fg_drawn_process *process, fg_drawn_foil *foil);
/* Draws the mean of `foils` foils. */
void fg_draw_mean(fg_drawer *drawer, const fg_drawn_process *process, double foils,
                  fg_drawn_foil *foil);
/* Draws one foil: a measured foil's deviations, or normal ones where there are none. */
void fg_draw_foil(fg_drawer *drawer, const fg_drawn_process *process, fg_drawn_foil *foil);

#endif
