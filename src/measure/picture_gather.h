/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of one scan's picture, from the states around all its measured edges. */
#ifndef FG_MEASURE_PICTURE_GATHER_H
#define FG_MEASURE_PICTURE_GATHER_H

#include "foilgauge/foil.h"

/* Fills m->picture, adds the findings of a colour scan's channels to every foil and disc, and names
 * findings in m->warning when that is empty. */
void fg_picture_gather(fg_measurement *m);

#endif
