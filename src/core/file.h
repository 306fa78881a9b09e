/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files; what of them is public stands in foilgauge/file.h. */
#ifndef FG_CORE_FILE_H
#define FG_CORE_FILE_H

#include "foilgauge/file.h"

/* The end of a writer into an open stream: FG_ERR_IO when a write has failed. `what` is what was
 * written, in words. */
fg_status fg_stream_finish(fg_context *ctx, FILE *out, const char *what);

#endif
