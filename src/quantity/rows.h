/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of quantities, one for each owner. */
#ifndef FG_QUANTITY_ROWS_H
#define FG_QUANTITY_ROWS_H

#include "foilgauge/quantity.h"

typedef struct fg_quantity_rows {
  const fg_quantity *rows;
  size_t count;
} fg_quantity_rows;

extern const fg_quantity_rows fg_quantities_of_foil, fg_quantities_of_bump, fg_quantities_of_beam,
    fg_quantities_of_disc, fg_quantities_of_strip, fg_quantities_of_bearing;

#define FG_QUANTITY_ROWS(table)                                                                    \
  { table, sizeof(table) / sizeof(table)[0] }

/* Offset of `member`, alone or with its uncertainty beside it. */
#define FG_AT(type, member) .offset = offsetof(type, member), .u_offset = FG_NO_UNCERTAINTY
#define FG_AT_U(type, member, u_member)                                                            \
  .offset = offsetof(type, member), .u_offset = offsetof(type, u_member)
#define FG_IN_COVARIANCE(type, member, row)                                                        \
  .covariance = offsetof(type, member), .covariance_row = (row)

#endif
