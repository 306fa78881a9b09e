/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file for each part in a folder.
 *
 * The file is first written whole under a hidden name; the database notes that; then the file is
 * renamed. A station that was killed in between finds by the hidden name whether it was: a receiver
 * may have taken the file away already. A mark in the folder tells it from an empty mount point. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/text.h"
#include "foilgauge/file.h"
#include "station/outbox/transport.h"

#define MARK ".foilgauge-outbox"

typedef struct folder {
  char *path, *mark;
} folder;

static void close_folder(void *way) {
  folder *at = way;
  free(at->path);
  free(at->mark);
  free(at);
}

static fg_status open_folder(fg_context *ctx, const char *to, const char *token,
                             const atomic_bool *closing, void **way) {
  (void)token;
  (void)closing;
  folder *at = calloc(1, sizeof *at);
  if (!at) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a folder");
  fg_status status = fg_text_print(ctx, &at->path, "%s", to);
  if (status == FG_OK) status = fg_text_print(ctx, &at->mark, "%s/%s", to, MARK);
  *way = at;
  if (status != FG_OK) close_folder(at);
  return status;
}

static fg_status find_names(fg_context *ctx, const folder *at, const fg_message *message,
                            char **hidden, char **name) {
  *hidden = *name = NULL;
  FG_TRY(fg_text_print(ctx, hidden, "%s/.%s.part", at->path, message->name));
  fg_status status = fg_text_print(ctx, name, "%s/%s", at->path, message->name);
  if (status != FG_OK) free(*hidden);
  return status;
}

static fg_status sync_folder(fg_context *ctx, const folder *at) {
  int file = open(at->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  bool done = file >= 0 && (fsync(file) == 0 || errno == EINVAL);
  int error = errno;
  if (file >= 0) close(file);
  return done ? FG_OK : fg_output_fail(ctx, at->path, error);
}

/* A folder gets its mark with its first part, and is that folder from then on. */
static fg_status make_mark(fg_context *ctx, const folder *at) {
  int file = open(at->mark, O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return fg_output_fail(ctx, at->path, errno);
  close(file);
  return FG_OK;
}

static fg_status prepare_file(fg_context *ctx, void *way, const fg_message *message) {
  folder *at = way;
  char *hidden, *name;
  fg_output output;
  FG_TRY(make_mark(ctx, at));
  FG_TRY(find_names(ctx, at, message, &hidden, &name));
  fg_status status = fg_output_open(ctx, hidden, &output);
  if (status == FG_OK) {
    fwrite(message->body, 1, message->size, output.stream);
    status = fg_output_commit(ctx, &output);
  }
  if (status == FG_OK) status = sync_folder(ctx, at);
  free(hidden);
  free(name);
  return status;
}

/* The hidden file is gone once it was renamed, unless the folder is another one. */
static fg_status rename_file(fg_context *ctx, const folder *at, const char *hidden,
                             const char *name) {
  if (rename(hidden, name) == 0) return sync_folder(ctx, at);
  if (errno != ENOENT) return fg_output_fail(ctx, name, errno);
  if (access(at->mark, F_OK) == 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO,
                 "%s: is not the folder that parts went to before, or is not mounted: it has no "
                 "file %s; make one there if parts are to go on there",
                 at->path, MARK);
}

static fg_status send_file(fg_context *ctx, void *way, const fg_message *message) {
  folder *at = way;
  char *hidden, *name;
  FG_TRY(find_names(ctx, at, message, &hidden, &name));
  fg_status status = rename_file(ctx, at, hidden, name);
  free(hidden);
  free(name);
  return status;
}

const fg_transport fg_transport_folder = {"", open_folder, prepare_file, send_file, close_folder};
