/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Single bumps that deviate from the others: raised (positive) or sunk, by their number. */
#ifndef FG_RENDER_LIFT_H
#define FG_RENDER_LIFT_H

#include <stdbool.h>

#include "render/members.h"

enum { FG_LIFT_BUMPS_MAX = 64 };

typedef struct fg_lift {
  double
      um[FG_LIFT_BUMPS_MAX]; /* of bump 1, 2, ..: its crown's move towards the bearing's middle */
  int last;                  /* the highest number that the spec names */
  bool whole; /* the bump's circle moves with its fillets; else its middle rises, its ends stay */
} fg_lift;

/* Reads members form and either of bumps, every with first, period_bumps with phase_deg (each times
 * amplitude_um), or values_um. */
fg_status fg_lift_parse(const fg_place *place, const cJSON *object, fg_lift *lift);

double fg_lift_largest_um(const fg_lift *lift); /* magnitude */

#endif
