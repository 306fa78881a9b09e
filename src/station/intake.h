/* A file of the folder, from its name to what is kept of it. */
#ifndef FG_STATION_INTAKE_H
#define FG_STATION_INTAKE_H

#include "station/state.h"

/* Looks at folder/name unless it is known as it is. `final`: nobody will write to it any more, as
 * far as can be known (closed, renamed, at rest); a file that is not whole then gets its card.
 * Without it such a file is left for later. *later: it has to be looked at again. FG_ERR_IO and
 * FG_ERR_MEMORY are the station's trouble; what is wrong with the file is its card. */
fg_status fg_station_take_file(fg_context *ctx, fg_inspection *station, const char *name,
                               bool final, bool *later);

/* By the scanner's model (NULL: none), with what the calibration does not know. A measurement that
 * cannot be corrected is freed. */
fg_status fg_station_correct(fg_context *ctx, const fg_scanner_model *model, unsigned threads,
                             fg_measurement *measurement);

#endif
