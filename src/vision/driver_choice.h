/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which of the models of a scanner's driver explains the profiles of a picture's edges. */
#ifndef FG_VISION_DRIVER_CHOICE_H
#define FG_VISION_DRIVER_CHOICE_H

#include "foilgauge/picture.h"
#include "vision/driver_model.h"

enum { FG_DRIVER_PROFILES = 16 }; /* that are asked */

/* Residuals that all profiles share, by distance from the edge. */
typedef struct fg_driver_misfit {
  double squares;  /* of their means over the profiles, counts² */
  double expected; /* of it by chance, as the profiles differ among each other */
  double rms;      /* of a cell, beyond chance */
  double cells;
} fg_driver_misfit;

void fg_driver_find_misfit(const fg_driven_profile *profiles, size_t count, const fg_driver *driver,
                           fg_driver_tone *tone, fg_driver_misfit *misfit);

/* What a driver does, and the findings that follow. */
void fg_driver_describe(const fg_driver *driver, fg_picture_state *state);

/* Whether a misfit is neither chance nor small beside the contrast. */
bool fg_driver_is_missed(const fg_driver_misfit *misfit, double contrast);

typedef struct fg_driver_choice {
  bool linear; /* set before: counts are proportional to the light, no tone curve is asked */
  fg_driver_fit fit;
  fg_driver_misfit misfit; /* that it leaves */
  double u_edge_px;        /* of its own, and as far as others that do as well differ */
  bool missed;             /* it does not explain the profiles either */
} fg_driver_choice;

/* Fits every model, starting from `profiles` (which become those of the best) and `gamma`. */
fg_status fg_driver_choose(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                           const double ends[2], double gamma, double noise,
                           fg_driver_choice *choice);

#endif
