/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows whose pixels are means of several columns and rows of a file. */
#ifndef FG_SCAN_AVERAGE_H
#define FG_SCAN_AVERAGE_H

#include <stddef.h>
#include <stdint.h>

#include "core/memory.h"

typedef struct fg_average {
  int columns, rows;   /* that become one pixel; 1 and 1: nothing is averaged */
  size_t width;        /* pixels of an averaged row */
  int bytes_per_pixel; /* 1 or 2, of both kinds of rows */
  uint32_t *sums;      /* owned */
} fg_average;

/* Room for sums; none where nothing is averaged. */
fg_status fg_average_open(fg_context *ctx, fg_average *average);
void fg_average_close(fg_average *average);

/* Adds a row of the file; columns beyond the last whole pixel are left out. */
void fg_average_add(fg_average *average, const void *row);

/* Writes the means of the rows that were added, and begins anew. */
void fg_average_put(fg_average *average, void *out);

#endif
