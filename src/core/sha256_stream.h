/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The SHA-256 of bytes as they come by. A long stream is summed on a thread of its own, beside
 * whoever feeds it; a short one, or where no thread is to be had or wanted, as it is fed. */
#ifndef FG_CORE_SHA256_STREAM_H
#define FG_CORE_SHA256_STREAM_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/parallel.h"
#include "core/sha256.h"

/* Stays where it is while it is in use: the thread knows its address. */
typedef struct fg_sha256_stream {
  struct sha256_ctx sum; /* of the thread, while there is one */
  uint8_t *ring;         /* NULL: no thread */
  uint64_t filled, taken;
  bool ended, alone; /* alone: no thread is to be had, or (set after begin) wanted */
  fg_thread thread;
  pthread_mutex_t lock;
  pthread_cond_t changed;
} fg_sha256_stream;

void fg_sha256_stream_begin(fg_sha256_stream *stream);
void fg_sha256_stream_feed(fg_sha256_stream *stream, const void *bytes, size_t count);

/* The sum of all that was fed; the stream begins afresh. */
void fg_sha256_stream_finish(fg_sha256_stream *stream, char hex[65]);

#endif
