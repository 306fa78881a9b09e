/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a closed lot, from its folder to a browser. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/text.h"
#include "station/lot_folder.h"
#include "station/pages.h"

/* Nothing else is served. */
static const struct {
  const char *name, *type;
} files[] = {
    {"foils.csv", "text/csv; charset=utf-8"},    {"bumps.csv", "text/csv; charset=utf-8"},
    {"results.qif", "application/xml"},          {"results.dfq", "text/plain; charset=utf-8"},
    {"index.html", "text/html; charset=utf-8"},  {"lot.json", "application/json"},
    {"manifest.csv", "text/csv; charset=utf-8"},
};

enum { FILES = sizeof files / sizeof *files, NAME_SHOWN = 100 };
#define FILE_BYTES_MAX ((off_t)1 << 29) /* a report of a lot of ten thousand foils is a fifth */

static fg_status is_closed(fg_context *ctx, sqlite3 *reader, const char *lot, bool *closed) {
  fg_query query;
  fg_query_begin(reader, "SELECT 1 FROM lots WHERE name = ? LIMIT 1", &query);
  fg_query_text(&query, lot);
  *closed = fg_query_row(&query);
  return fg_query_end(ctx, &query, "reading the lots");
}

static fg_status read_whole(fg_context *ctx, int file, const char *path, size_t size, char *bytes) {
  for (size_t done = 0; done < size;) {
    ssize_t got = read(file, bytes + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    if (got == 0) return fg_fail(ctx, FG_ERR_IO, "%s: is being written: try again", path);
    done += (size_t)got;
  }
  return FG_OK;
}

/* No link: it might lead out of the folder. */
static fg_status read_file(fg_context *ctx, const char *path, char **bytes, size_t *size) {
  struct stat info;
  void *block = NULL;
  int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0 || fstat(file, &info) != 0 || !S_ISREG(info.st_mode) ||
      info.st_size > FILE_BYTES_MAX) {
    if (file >= 0) close(file);
    return fg_fail(ctx, FG_ERR_USAGE, "%s: the report is not there; close the lot again", path);
  }
  *size = (size_t)info.st_size;
  fg_status status = fg_memory_allocate(ctx, *size + 1, 1, &block);
  if (status == FG_OK) status = read_whole(ctx, file, path, *size, block);
  close(file);
  if (status != FG_OK) free(block);
  *bytes = status == FG_OK ? block : NULL;
  return status;
}

static fg_status read_lot_file(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                               const char *lot, const char *name, char **bytes, size_t *size) {
  bool closed;
  char *folder, *path = NULL;
  FG_TRY(is_closed(ctx, reader, lot, &closed));
  if (!closed) return fg_fail(ctx, FG_ERR_USAGE, "The lot '%.127s' is not closed.", lot);
  FG_TRY(fg_lot_folder_find(ctx, station->request->folder, lot, false, &folder));
  fg_status status = fg_text_print(ctx, &path, "%s/%s", folder, name);
  if (status == FG_OK) status = read_file(ctx, path, bytes, size);
  free(path);
  free(folder);
  return status;
}

fg_status fg_page_lot(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                      const fg_request *request, FILE *out) {
  char *bytes = NULL;
  size_t size = 0;
  FG_TRY(read_lot_file(ctx, station, reader, fg_request_get(request, "name"), "index.html", &bytes,
                       &size));
  fwrite(bytes, 1, size, out);
  free(bytes);
  return FG_OK;
}

/* Makes a file name that an HTTP header can hold. */
static void name_download(const char *lot, const char *file, char *name, size_t size) {
  char folder[FG_LOT_FOLDER_NAME];
  fg_lot_folder_name(lot, folder);
  for (char *at = folder; *at; at++)
    if ((unsigned char)*at >= 0x80 || *at == '%' || *at == ';' || *at == '\'') *at = '_';
  fg_text_clip(name, size, "%.*s-%s", NAME_SHOWN, folder, file);
}

fg_status fg_action_download(fg_context *ctx, fg_inspection *station, const fg_request *request,
                             fg_answer *answer) {
  const char *lot = fg_request_get(request, "lot"), *file = fg_request_get(request, "file");
  size_t i = 0;
  while (i < FILES && strcmp(file, files[i].name) != 0)
    i++;
  if (i == FILES) return fg_fail(ctx, FG_ERR_USAGE, "There is no such file of a lot.");
  pthread_mutex_lock(&station->database.reading);
  fg_status status = read_lot_file(ctx, station, station->database.reader, lot, files[i].name,
                                   &answer->body, &answer->size);
  pthread_mutex_unlock(&station->database.reading);
  FG_TRY(status);
  answer->code = 200;
  answer->type = files[i].type;
  name_download(lot, files[i].name, answer->download, sizeof answer->download);
  return FG_OK;
}
