/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strip along its midline: the pieces of the die, and the curve that their curvatures make. */
#ifndef FG_FORMING_STRIP_H
#define FG_FORMING_STRIP_H

#include "foilgauge/forming.h"

/* Fills design, options and die of `forming`, its pieces, the bumps' die values and the length.
 * FG_ERR_DATA: a foil kind without curvature, a die whose bumps overlap. */
fg_status fg_forming_lay_out(fg_context *ctx, fg_forming *forming);

/* Draws the midline of the free strip, or of the die, with both edges, stations every 8 um, as
 * input for the measurement. The strip belongs to the caller. */
fg_status fg_forming_draw(fg_context *ctx, const fg_forming *forming, bool of_die, fg_strip *strip);

/* Effect of a pitch on everything after it: it turns by turn_rad and shifts by chord_mm; means over
 * the pitches from one land's middle to the next. Arc: from end to end. */
typedef struct fg_forming_pitch {
  double turn_rad, chord_mm;
} fg_forming_pitch;
fg_forming_pitch fg_forming_pitch_of(const fg_forming *forming, bool of_die);

#endif
