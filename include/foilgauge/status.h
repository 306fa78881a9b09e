/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status of a call, and the message of its error.
 *
 * Every public function that can fail returns fg_status; results come last in its parameters. The
 * message (file, error, place, remedy) lies in a context that the caller owns, one per thread. The
 * library keeps no globals, never prints and never exits.
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
  char message[1024]; /* of the last error; empty when there was none */
} fg_context;

/* Writes the message into the context (NULL is allowed) and returns `status`, so that a caller can
 * write `return fg_fail(ctx, FG_ERR_DATA, "%s: ...", path);`. It replaces an earlier message. */
fg_status fg_fail(fg_context *ctx, fg_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Returns the status of a system call that failed with `error` (errno): FG_ERR_MEMORY for exhausted
 * memory, else FG_ERR_IO. */
fg_status fg_status_of_errno(int error);

/* Returns the exit code of a status. */
int fg_status_exit_code(fg_status status);

/* Forwards an error to the caller. */
#define FG_TRY(call)                                                                               \
  do {                                                                                             \
    fg_status fg_try_status_ = (call);                                                             \
    if (fg_try_status_ != FG_OK) return fg_try_status_;                                            \
  } while (0)

/* Forwards an error in a function that has something to free: sets `status` and jumps to the one
 * `exit:` label. */
#define FG_TRY_EXIT(call)                                                                          \
  do {                                                                                             \
    status = (call);                                                                               \
    if (status != FG_OK) goto exit;                                                                \
  } while (0)

#ifdef __cplusplus
}
#endif
#endif
