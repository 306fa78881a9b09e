/* What an output must not take the place of: an input, or another output.
 *
 * Files are told apart by device and inode, so that no spelling, link or redirection hides that two
 * names are one; a file that is not there yet, by the folder that it will be in and its name.
 * Devices can be named as often as one likes. */
#ifndef FG_CORE_OVERWRITE_H
#define FG_CORE_OVERWRITE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_overwrite {
  struct fg_output_place *places; /* of the outputs */
  size_t count;
} fg_overwrite;

/* Looks up the outputs: NULL is none, "-" standard output. FG_ERR_USAGE when two are one file. All
 * zero before; fg_overwrite_free in any case. */
fg_status fg_overwrite_begin(fg_context *ctx, const char *const *outputs, size_t count,
                             fg_overwrite *overwrite);

/* FG_ERR_USAGE when an output would overwrite `input`, called so in `words` ("the scan"). NULL is
 * no input, "-" standard input. */
fg_status fg_overwrite_check(fg_context *ctx, const fg_overwrite *overwrite, const char *input,
                             const char *words);

bool fg_overwrite_is_same(const char *a,
                          const char *b); /* one file, or one that is not there yet */

void fg_overwrite_free(fg_overwrite *overwrite);

#ifdef __cplusplus
}
#endif
#endif
