/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a call came to, and the words that go with it.
 *
 * Every public function that can fail returns fg_status; results come last in its parameters.
 * The words (which file, what is wrong, where, what to do) lie in a context that the caller owns,
 * one per thread. The library keeps no globals, never prints and never exits.
 */
#ifndef FOILGAUGE_STATUS_H
#define FOILGAUGE_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_status {
  FG_OK = 0,
  FG_ERR_USAGE,        /* the call or the command line is wrong: exit 64 */
  FG_ERR_DATA,         /* a file's content is wrong: exit 65 */
  FG_ERR_IO,           /* a file cannot be read or written: exit 74 */
  FG_ERR_MEMORY,       /* out of memory: exit 71 */
  FG_ERR_NUMERIC,      /* a fit did not converge; usually a flag on one object: exit 65 */
  FG_ERR_INTERRUPTED,  /* stopped by a signal: exit 130 */
  FG_ERR_NOT_MEASURED, /* nothing in the input could be measured: exit 2 */
} fg_status;

typedef struct fg_context {
  char message[1024]; /* the last error in words; empty when there was none */
} fg_context;

/* Writes the words into the context (NULL is allowed) and returns `status`, so that a caller can
 * say `return fg_fail(ctx, FG_ERR_DATA, "%s: ...", path);`. A message that is there already is
 * replaced. */
fg_status fg_fail(fg_context *ctx, fg_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The status of a call of the system that failed with `error` (errno): FG_ERR_MEMORY where it was for
 * want of memory, else FG_ERR_IO. */
fg_status fg_status_of_errno(int error);

/* The exit code that goes with a status. */
int fg_status_exit_code(fg_status status);

/* Forwards an error to the caller. */
#define FG_TRY(call)                                                                               \
  do {                                                                                             \
    fg_status fg_try_status_ = (call);                                                             \
    if (fg_try_status_ != FG_OK) return fg_try_status_;                                            \
  } while (0)

/* The same where there is something to free: sets `status` and jumps to the one `exit:` label. */
#define FG_TRY_EXIT(call)                                                                          \
  do {                                                                                             \
    status = (call);                                                                               \
    if (status != FG_OK) goto exit;                                                                \
  } while (0)

#ifdef __cplusplus
}
#endif
#endif
