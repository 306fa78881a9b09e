/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closing a lot: writes its folder and report, and records who closed it. */
#ifndef FG_STATION_CLOSE_H
#define FG_STATION_CLOSE_H

#include "station/state.h"

/* Waits for a lot that is being closed. */
void fg_closing_end(fg_closing *closing);

#endif
