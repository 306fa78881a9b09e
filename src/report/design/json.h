/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design and its nominal values as JSON, in a file of its own or inside another report. */
#ifndef FG_REPORT_DESIGN_JSON_H
#define FG_REPORT_DESIGN_JSON_H

#include "core/json_writer.h"
#include "foilgauge/design.h"

/* Writes the members as a design file has them; fg_design_parse reads them again. */
void fg_json_design(fg_json *json, const char *name, const fg_design *design);
void fg_json_nominal(fg_json *json, const char *name, const fg_nominal *nominal);

#endif
