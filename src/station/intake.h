/* A file of the folder, from its name to what is kept of it. */
#ifndef FG_STATION_INTAKE_H
#define FG_STATION_INTAKE_H

#include "station/state.h"

/* What is known of who writes a file. */
typedef enum fg_writer {
  FG_WRITER_WRITES, /* as far as is known: what is surely whole is taken */
  FG_WRITER_PAUSES, /* it is closed, renamed or at rest: what seems whole is taken */
  FG_WRITER_GONE    /* nothing has come for receive_s: what is not whole gets its card */
} fg_writer;

/* Looks at folder/name unless it is known as it is. What is not taken is left for later: *later
 * says that it has to be looked at again. FG_ERR_IO and
 * FG_ERR_MEMORY are the station's trouble; what is wrong with the file is its card. */
fg_status fg_station_take_file(fg_context *ctx, fg_inspection *station, const char *name,
                               fg_writer writer, bool *later);

/* By the scanner's model (NULL: none), with what the calibration does not know. A measurement that
 * cannot be corrected is freed. */
fg_status fg_station_correct(fg_context *ctx, const fg_scanner_model *model, unsigned threads,
                             fg_measurement *measurement);

#endif
