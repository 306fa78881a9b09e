/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of one scan's picture, from what was found around all that was measured in it. */
#ifndef FG_MEASURE_PICTURE_GATHER_H
#define FG_MEASURE_PICTURE_GATHER_H

#include "foilgauge/foil.h"

/* Fills m->picture, adds what the channels of a colour scan say to every foil and disc, and says in
 * m->warning what was found where nothing else is odd. */
void fg_picture_gather(fg_measurement *m);

#endif
