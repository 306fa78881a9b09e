/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The strip along its midline: the stretches of the die, and the curve that curvatures make. */
#ifndef FG_FORMING_STRIP_H
#define FG_FORMING_STRIP_H

#include "foilgauge/forming.h"

/* Fills design, options, die of `forming` in, pieces, bumps' die values and length out.
 * FG_ERR_DATA: a form without curvature, a die whose bumps overlap. */
fg_status fg_forming_lay_out(fg_context *ctx, fg_forming *forming);

/* The midline with both edges, stations every 8 um, as `measure` takes it. The strip belongs to the
 * caller. */
fg_status fg_forming_draw(fg_context *ctx, const fg_forming *forming, fg_strip *strip);

/* What a pitch does to what comes after it: it turns by turn_rad and shifts by chord_mm; means over
 * the pitches from one land's middle to the next. Arc: from end to end. */
typedef struct fg_forming_pitch {
  double turn_rad, chord_mm;
} fg_forming_pitch;
fg_forming_pitch fg_forming_pitch_of(const fg_forming *forming, bool of_die);

#endif
