/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The member `station` of a recipe, as a document: fg_station_settings_load reads it. */
#ifndef FG_STATION_SETTINGS_H
#define FG_STATION_SETTINGS_H

#include "core/member_read.h"

extern const fg_document fg_station_settings_document;

#endif
