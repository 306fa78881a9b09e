/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Documents of a station. The member `station` of a recipe is one: fg_station_settings_load reads
 * it. */
#ifndef FG_STATION_SETTINGS_H
#define FG_STATION_SETTINGS_H

#include "core/member_read.h"

extern const fg_document fg_station_settings_document;

/* A part as it is passed on, the state of that (station/outbox/), and parts of stations
 * (station/hub/). */
extern const fg_document fg_part_document, fg_outbox_document, fg_hub_document;

#endif
