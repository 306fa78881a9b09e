/* What the loop on scans says of its effects: decided once, for JSON, page, text and model. */
#ifndef FG_SCAN_LOOP_VERDICT_H
#define FG_SCAN_LOOP_VERDICT_H

#include "foilgauge/status.h"

struct fg_scan_loop;

/* An effect of this size would be a nuisance: what could have been shown at it and was not is
 * `absent`. */
#define FG_SCAN_LOOP_MATTERS_UM 3.0

/* Fills `result` of the loop from what was searched and fitted; anew when it was filled before. */
fg_status fg_scan_loop_decide(fg_context *ctx, struct fg_scan_loop *loop);

#endif
