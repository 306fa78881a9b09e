/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intake of a file of the folder, from its name to its record in the database. */
#ifndef FG_STATION_INTAKE_H
#define FG_STATION_INTAKE_H

#include "station/state.h"

/* State of the process that writes a file. */
typedef enum fg_writer {
  FG_WRITER_WRITES, /* perhaps still: only a surely whole file is read */
  FG_WRITER_PAUSES, /* the file is closed, renamed or unchanged for a while: it is read if it seems
                       whole */
  FG_WRITER_GONE    /* nothing has come for receive_s: an incomplete file gets its card */
} fg_writer;

/* Inspects folder/name unless it was inspected in this state. A file that is not accepted yet
 * sets *later: it has to be inspected again. FG_ERR_IO and FG_ERR_MEMORY are failures of the
 * station; a fault of the file is its card. */
fg_status fg_station_inspect_file(fg_context *ctx, fg_inspection *station, const char *name,
                                  fg_writer writer, bool *later);

/* Corrects a measurement by the scanner's model (NULL: none) and adds the uncertainty of the
 * calibration. A measurement that cannot be corrected is freed. */
fg_status fg_station_correct(fg_context *ctx, const fg_scanner_model *model, unsigned threads,
                             fg_measurement *measurement);

#endif
