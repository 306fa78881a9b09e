/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils measured while their scan is still read: islands go to worker threads as they are
 * complete, and their tiles are let go when they are measured. The reader lends a hand when the
 * workers fall behind, so what waits is bounded. */
#ifndef FG_MEASURE_SESSION_H
#define FG_MEASURE_SESSION_H

#include "foilgauge/foil.h"
#include "vision/islands.h"

typedef struct fg_session fg_session;

/* `measurement` must hold design and dpi; foils are added to it by fg_session_finish. */
fg_status fg_session_create(fg_context *ctx, fg_measurement *measurement, unsigned threads,
                            fg_session **session);

/* Takes in the strips that came since the last call (fg_reader_visit). */
fg_status fg_session_advance(fg_context *ctx, fg_tiles *tiles, void *session);

/* Waits for what is under way and puts the foils into reading order: rows of foils from top to
 * bottom, each from left to right. */
fg_status fg_session_finish(fg_context *ctx, fg_session *session);

void fg_session_free(fg_session *session); /* stops the workers; NULL is fine */

#endif
