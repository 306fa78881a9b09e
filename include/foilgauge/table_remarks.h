/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Oddities of a table that no model sees: copied rows, a value in another unit, a gauge at the end
 * of its range, one name written in two ways, numbers with their unit in the cell. */
#ifndef FOILGAUGE_TABLE_REMARKS_H
#define FOILGAUGE_TABLE_REMARKS_H

#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Appends the oddities to `said` (NULL at first; the caller frees it), each with the rows or cells
 * that show it, and its consequence; nothing where there are none. */
fg_status fg_table_remark(fg_context *ctx, const fg_table *table, const char *response,
                          char **said);

#ifdef __cplusplus
}
#endif
#endif
