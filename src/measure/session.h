/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils measured while their scan is still read.
 *
 * Complete islands go to worker threads, and their tiles are released after measuring. The reader
 * helps when the workers fall behind, so the queue is bounded. */
#ifndef FG_MEASURE_SESSION_H
#define FG_MEASURE_SESSION_H

#include "foilgauge/foil.h"
#include "vision/islands.h"

typedef struct fg_session fg_session;

/* `measurement` must hold design and dpi; foils are added to it by fg_session_finish. `plain`: as
 * of fg_edge_options, whether or not the design has gauges. */
fg_status fg_session_create(fg_context *ctx, fg_measurement *measurement, unsigned threads,
                            bool plain, fg_session **session);

/* Accepts the strips since the last call (fg_reader_visit). */
fg_status fg_session_advance(fg_context *ctx, fg_tiles *tiles, void *session);

/* Waits for running work and puts the foils into reading order: rows of foils from top to bottom,
 * each from left to right. */
fg_status fg_session_finish(fg_context *ctx, fg_session *session);

void fg_session_free(fg_session *session); /* stops the workers; NULL is fine */

#endif
