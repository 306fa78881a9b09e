/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measurement of a scan. */
#ifndef FOILGAUGE_MEASURE_H
#define FOILGAUGE_MEASURE_H

#include "foilgauge/foil.h"
#include "foilgauge/scan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reports the progress of reading; called by the thread that called fg_measure_scan. */
typedef void fg_measure_progress(void *user, int64_t rows_done, int64_t rows);

/* Default limit of a scan's rows and tiles. */
#define FG_MEASURE_MEMORY_CAP_MIB 2048

typedef struct fg_measure_options {
  double dpi;         /* 0: the file's */
  unsigned threads;   /* 0: one per core */
  fg_channel channel; /* of a colour scan */
  bool allow_lossy;   /* as in fg_scan_options */
  bool only_file;     /* as in fg_scan_options */
  bool sum_failed;    /* also find the SHA-256 of a file that cannot be measured */
  bool without_plain; /* no scanner's model with a level follows: see fg_strip.plain_mm */
  uint64_t pixel_cap; /* refuse larger scans; 0: FG_SCAN_PIXEL_CAP */
  size_t memory_cap;  /* limit of rows and tiles, bytes; 0: FG_MEASURE_MEMORY_CAP_MIB */
  fg_measure_progress *progress; /* NULL: none */
  void *progress_user;
} fg_measure_options;

/* Reads the scan once and measures every foil (or disc) in it. `path` may be "-" for standard
 * input. On success the caller frees with fg_measurement_free. FG_ERR_DATA when there is nothing to
 * measure, or when memory_cap is reached (a scan that is dirty all over); a foil that cannot be
 * measured is flagged FG_FOIL_NOT_MEASURED. On failure the measurement is all zero. With
 * `sum_failed` its sha256 is that of the whole file nevertheless; "" when the file could not be
 * read, changed meanwhile, or is no regular file. */
fg_status fg_measure_scan(fg_context *ctx, const char *path, const fg_design *design,
                          const fg_measure_options *options, fg_measurement *measurement);

/* Adds the calibration's uncertainty to every u_, once; a design without a calibration changes
 * nothing. Call it after everything that corrects values, before anything that reports or judges
 * them: a search in residuals, by a loop or a model, must not see it. A foil is given up when its
 * stretched edges are no foil any more. */
fg_status fg_measurement_calibrate(fg_context *ctx, unsigned threads, fg_measurement *measurement);

#ifdef __cplusplus
}
#endif
#endif
