/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SHA-256 of a stream of bytes.
 *
 * A long stream is summed on a thread of its own, beside the caller. A short one is summed as it is
 * fed, and so is any stream when no thread is available or wanted. */
#ifndef FG_CORE_SHA256_STREAM_H
#define FG_CORE_SHA256_STREAM_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/parallel.h"
#include "core/sha256.h"

/* Keeps its address while it is in use: the thread holds it. */
typedef struct fg_sha256_stream {
  struct sha256_ctx sum; /* used by the thread, while there is one */
  uint8_t *ring;         /* NULL: no thread */
  uint64_t filled, taken;
  bool ended, alone; /* alone: no thread is available, or (set after begin) wanted */
  fg_thread thread;
  pthread_mutex_t lock;
  pthread_cond_t changed;
} fg_sha256_stream;

void fg_sha256_stream_begin(fg_sha256_stream *stream);
void fg_sha256_stream_feed(fg_sha256_stream *stream, const void *bytes, size_t count);

/* Writes the sum of all bytes fed; the stream begins anew. */
void fg_sha256_stream_finish(fg_sha256_stream *stream, char hex[65]);

#endif
