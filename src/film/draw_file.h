/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File of drawn bearings, a line each, which is written as they are solved: a run that was killed
 * goes on from it, and files of several machines are joined by appending one to the other. */
#ifndef FG_FILM_DRAW_FILE_H
#define FG_FILM_DRAW_FILE_H

#include <pthread.h>

#include "film/stock.h"

typedef struct fg_film_draw_file {
  const char *path;
  FILE *stream; /* NULL: nothing is kept */
  pthread_mutex_t lock;
  bool *known; /* by draw; owned; NULL: none */
  size_t count;
} fg_film_draw_file;

/* Reads the draws of options.draw.keep into `draws`, whose array is there, and opens the file for
 * more. FG_ERR_DATA for a file of other draws: another bearing, load, mesh, seed, or program. */
fg_status fg_film_draw_file_open(fg_context *ctx, const fg_film_report *report,
                                 const fg_film_bearing *perfect, const fg_film_stock *stock,
                                 fg_film_draws *draws, fg_film_draw_file *file);
/* Adds a solved draw, from any thread. */
fg_status fg_film_draw_file_add(fg_context *ctx, fg_film_draw_file *file,
                                const fg_film_result *result);
fg_status fg_film_draw_file_close(fg_context *ctx, fg_film_draw_file *file);

#endif
