/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of quantities as members of JSON. */
#ifndef FG_REPORT_QUANTITY_JSON_H
#define FG_REPORT_QUANTITY_JSON_H

#include "core/json_writer.h"
#include "foilgauge/quantity.h"

/* Writes the rows whose names start with `group` ("overall.", which is cut off: they stand in an
 * object of their own) or, when it is empty, have no dot; `known` false: numbers are null. */
void fg_json_quantities(fg_json *json, fg_quantity_owner owner, const char *group,
                        const void *object, bool known);

#endif
