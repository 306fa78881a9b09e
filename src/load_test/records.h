/* Samples of every direction, from the files. */
#ifndef FG_LOAD_TEST_RECORDS_H
#define FG_LOAD_TEST_RECORDS_H

#include "foilgauge/load_test.h"

/* Where a record begins among test->samples: a direction that goes on in another file. */
typedef struct fg_load_records {
  size_t *begin; /* ascending; every direction's first sample is one of them */
  size_t count, capacity;
} fg_load_records;

/* Fills files, bearings (names), directions (bearing, azimuth, pad, first, count) and samples. */
fg_status fg_load_records_read(fg_context *ctx, const fg_load_source *sources, size_t count,
                               fg_load_test *test, fg_load_records *records);
void fg_load_records_free(fg_load_records *records);

#endif
