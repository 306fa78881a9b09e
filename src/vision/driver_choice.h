/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choice of the model of a scanner's driver that explains the profiles of a picture's edges. */
#ifndef FG_VISION_DRIVER_CHOICE_H
#define FG_VISION_DRIVER_CHOICE_H

#include "foilgauge/picture.h"
#include "vision/driver_places.h"

enum { FG_DRIVER_PROFILES = 16 }; /* max number of profiles in a fit */

/* Residuals that all profiles share, by distance from the edge. */
typedef struct fg_driver_misfit {
  double squares;  /* of the residuals' means over the profiles, counts² */
  double expected; /* `squares` expected by chance, from the differences among the profiles */
  double rms;      /* of a cell, beyond chance */
  double cells;
} fg_driver_misfit;

/* Room for fg_driver_find_misfit; free it by fg_driver_scratch_free (NULL: nothing). */
typedef struct fg_driver_scratch {
  fg_driver_tone tone;
  fg_driven_places places;
} fg_driver_scratch;

fg_status fg_driver_scratch_create(fg_context *ctx, fg_driver_scratch **scratch);
void fg_driver_scratch_free(fg_driver_scratch *scratch);

void fg_driver_find_misfit(const fg_driven_profile *profiles, size_t count, const fg_driver *driver,
                           fg_driver_scratch *scratch, fg_driver_misfit *misfit);

/* Fills the driver's values in `state`, and the findings that follow. */
void fg_driver_describe(const fg_driver *driver, fg_picture_state *state);

/* Returns true when a misfit is more than chance and not small beside the contrast. */
bool fg_driver_is_missed(const fg_driver_misfit *misfit, double contrast);

typedef struct fg_driver_choice {
  unsigned threads; /* set before; 0: all cores */
  bool linear;      /* set before: counts are proportional to the light, no tone curve is sought */
  fg_driver_fit fit;
  fg_driver_misfit misfit; /* of the chosen model */
  double u_edge_px;        /* the model's own, and the spread of models that do as well */
  bool missed;             /* the chosen model does not explain the profiles either */
} fg_driver_choice;

/* Fits every model, starting from `profiles` (which become those of the best) and `gamma`. */
fg_status fg_driver_choose(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                           const double ends[2], double gamma, double noise,
                           fg_driver_choice *choice);

#endif
