/* From a scan to its measurement. */
#ifndef FOILGAUGE_MEASURE_H
#define FOILGAUGE_MEASURE_H

#include "foilgauge/foil.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_measure_options {
  double dpi;       /* 0: as the file says */
  unsigned threads; /* 0: as many as there are cores */
} fg_measure_options;

/* Reads the scan once and measures every foil (or disc) in it. `path` may be "-" for standard
 * input. On success the caller frees with fg_measurement_free. FG_ERR_DATA when there is nothing
 * to measure; a foil that cannot be measured is flagged FG_FOIL_NOT_MEASURED. */
fg_status fg_measure_scan(fg_context *ctx, const char *path, const fg_design *design,
                          const fg_measure_options *options, fg_measurement *measurement);

#ifdef __cplusplus
}
#endif
#endif
