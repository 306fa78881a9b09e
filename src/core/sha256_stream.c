/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/sha256_stream.h"

#include <stdlib.h>
#include <string.h>

/* ALONE_BYTES: bytes summed before the start of a thread is worth it. */
enum { RING_BYTES = 1 << 20, ALONE_BYTES = 1 << 20, PIECE_BYTES = 1 << 17 };

static size_t min_of_three(size_t a, size_t b, size_t c) {
  size_t min = a < b ? a : b;
  return min < c ? min : c;
}

static void *sum_ring(void *argument) {
  fg_sha256_stream *s = argument;
  pthread_mutex_lock(&s->lock);
  for (;;) {
    while (s->filled == s->taken && !s->ended)
      pthread_cond_wait(&s->changed, &s->lock);
    if (s->filled == s->taken) break;
    size_t at = (size_t)(s->taken % RING_BYTES);
    size_t count = min_of_three((size_t)(s->filled - s->taken), RING_BYTES - at, PIECE_BYTES);
    pthread_mutex_unlock(&s->lock);
    sha256_update(&s->sum, count, s->ring + at);
    pthread_mutex_lock(&s->lock);
    s->taken += count;
    pthread_cond_signal(&s->changed);
  }
  pthread_mutex_unlock(&s->lock);
  return NULL;
}

static void start_thread(fg_sha256_stream *s) {
  s->ring = malloc(RING_BYTES);
  s->taken = s->filled;
  s->ended = false;
  pthread_mutex_init(&s->lock, NULL);
  pthread_cond_init(&s->changed, NULL);
  if (s->ring && fg_thread_start(&s->thread, sum_ring, s) == FG_OK) return;
  pthread_mutex_destroy(&s->lock);
  pthread_cond_destroy(&s->changed);
  free(s->ring);
  s->ring = NULL;
  s->alone = true;
}

static void end_thread(fg_sha256_stream *s) {
  pthread_mutex_lock(&s->lock);
  s->ended = true;
  pthread_cond_signal(&s->changed);
  pthread_mutex_unlock(&s->lock);
  fg_thread_join(&s->thread);
  pthread_mutex_destroy(&s->lock);
  pthread_cond_destroy(&s->changed);
  free(s->ring);
  s->ring = NULL;
}

static void fill_ring(fg_sha256_stream *s, const uint8_t *bytes, size_t left) {
  pthread_mutex_lock(&s->lock);
  while (left > 0) {
    while (s->filled - s->taken == RING_BYTES)
      pthread_cond_wait(&s->changed, &s->lock);
    size_t at = (size_t)(s->filled % RING_BYTES);
    size_t count = min_of_three(left, RING_BYTES - at, RING_BYTES - (size_t)(s->filled - s->taken));
    pthread_mutex_unlock(&s->lock);
    memcpy(s->ring + at, bytes, count);
    bytes += count;
    left -= count;
    pthread_mutex_lock(&s->lock);
    s->filled += count;
    pthread_cond_signal(&s->changed);
  }
  pthread_mutex_unlock(&s->lock);
}

void fg_sha256_stream_begin(fg_sha256_stream *s) {
  *s = (fg_sha256_stream){.ring = NULL};
  sha256_init(&s->sum);
}

void fg_sha256_stream_feed(fg_sha256_stream *s, const void *bytes, size_t count) {
  if (!s->ring && !s->alone && s->filled >= ALONE_BYTES) start_thread(s);
  if (s->ring) {
    fill_ring(s, bytes, count);
    return;
  }
  s->filled += count;
  sha256_update(&s->sum, count, bytes);
}

void fg_sha256_stream_finish(fg_sha256_stream *s, char hex[65]) {
  if (s->ring) end_thread(s);
  fg_sha256_finish(&s->sum, hex);
  const bool alone = s->alone;
  fg_sha256_stream_begin(s);
  s->alone = alone;
}
