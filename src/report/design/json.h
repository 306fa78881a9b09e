/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design as JSON inside another document. */
#ifndef FG_REPORT_DESIGN_JSON_H
#define FG_REPORT_DESIGN_JSON_H

#include "core/json_writer.h"
#include "foilgauge/design.h"

/* Writes the members as a design file has them; fg_design_parse reads them again. */
void fg_json_design(fg_json *json, const char *name, const fg_design *design);

#endif
