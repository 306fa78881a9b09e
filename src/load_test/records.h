/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples of every direction, from the files. */
#ifndef FG_LOAD_TEST_RECORDS_H
#define FG_LOAD_TEST_RECORDS_H

#include "foilgauge/load_test.h"

/* Begin of each record among test->samples: a direction may continue in another file. */
typedef struct fg_load_records {
  size_t *begin; /* ascending; every direction's first sample is one of them */
  size_t count, capacity;
} fg_load_records;

/* maximum size of a test's file */
enum { FG_LOAD_BYTES_MAX = 256 << 20 };

/* Fills files (with room for break-away tests), bearings (names), directions (bearing, azimuth,
 * pad, first, count) and samples. */
fg_status fg_load_records_read(fg_context *ctx, const fg_load_source *sources, size_t count,
                               fg_load_test *test, fg_load_records *records);

/* Finds the bearing of that name; adds it when there is none. */
fg_status fg_load_find_bearing(fg_context *ctx, fg_load_test *test, const char *name,
                               size_t *index);

/* The file's name less its folder and ending. */
const char *fg_load_file_stem(const char *path, char *text, size_t size);

/* FG_ERR_DATA when the last file has the same bytes as an earlier one. */
fg_status fg_load_check_new(fg_context *ctx, const fg_load_test *test);

void fg_load_records_free(fg_load_records *records);

#endif
