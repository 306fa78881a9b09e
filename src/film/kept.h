/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File of drawn bearings: a line each, written as they are solved, so that a run that was killed
 * goes on, and parts of other machines can be joined by writing one file behind the other. */
#ifndef FG_FILM_KEPT_H
#define FG_FILM_KEPT_H

#include <pthread.h>

#include "film/stock.h"

typedef struct fg_film_kept {
  const char *path;
  FILE *file; /* NULL: nothing is kept */
  pthread_mutex_t lock;
  bool *known; /* by draw; owned; NULL: none */
  size_t count;
} fg_film_kept;

/* Reads the draws of options.keep into `draws`, whose array is there, and opens the file for more.
 * FG_ERR_DATA for a file of other draws: another bearing, load, mesh, seed, or program. */
fg_status fg_film_kept_open(fg_context *ctx, const fg_film_report *report,
                            const fg_film_bearing *perfect, const fg_film_stock *stock,
                            fg_film_draws *draws, fg_film_kept *kept);
/* Adds a solved draw, from any thread. */
fg_status fg_film_kept_add(fg_context *ctx, fg_film_kept *kept, const fg_film_result *result);
fg_status fg_film_kept_close(fg_context *ctx, fg_film_kept *kept);

#endif
