/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trail: every action of a known user, done or refused. */
#ifndef FG_STATION_TRAIL_H
#define FG_STATION_TRAIL_H

#include "station/request.h"

/* Keeps an action of the user who asks; of nobody where the station knows no users. `refused`: the
 * reason, or "". An action that is done stays done where this cannot be kept. */
void fg_trail_keep(fg_inspection *station, const fg_request *request, const char *refused);

/* The newest actions, /trail. */
fg_page_writer fg_page_trail;

#endif
