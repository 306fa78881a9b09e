/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail: every action of a known user, done or refused. */
#ifndef FG_STATION_AUDIT_TRAIL_H
#define FG_STATION_AUDIT_TRAIL_H

#include "station/request.h"

/* Adds an action of the user who asks; none where the station knows no users. `refused`: the
 * reason, or "". An action that is done stays done where this cannot be kept. */
void fg_audit_trail_add(fg_inspection *station, const fg_request *request, const char *refused);

/* The newest actions, /trail. */
fg_page_writer fg_page_audit_trail;

#endif
