/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/lot_folder.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/sha256.h"
#include "core/text.h"
#include "core/utf8.h"
#include "lot/run/folder_lock.h"
#include "lot/run/lot.h"

#define WITHOUT_LOT "without_lot"

/* LONGEST leaves room in the 255 bytes of a name for the checksum of the part cut off. */
enum { LONGEST = 200, SUM_DIGITS = 16 };

/* True for bytes that all file systems accept; at the edges of a name some cut bytes off. */
static bool is_plain_byte(const char *at, bool edge) {
  unsigned char c = (unsigned char)*at;
  if (c < ' ' || c == 0x7f || strchr("%/\\:*?\"<>|", c)) return false;
  return !edge || (c != '.' && c != ' ');
}

static size_t put_byte(char *name, const char *at, size_t bytes, bool plain) {
  size_t length = 0;
  for (size_t i = 0; i < bytes; i++)
    length += (size_t)snprintf(name + length, 4, plain ? "%c" : "%%%02X", (unsigned char)at[i]);
  return length;
}

void fg_lot_folder_name(const char *lot, char name[FG_LOT_FOLDER_NAME]) {
  char sum[65];
  size_t length = 0;
  const char *at = lot;
  name[0] = '\0';
  while (*at && length < LONGEST) {
    size_t valid = fg_utf8_length(at), bytes = valid ? valid : 1;
    bool edge = at == lot || !at[bytes];
    bool reserved = at == lot && !strcmp(lot, WITHOUT_LOT);
    length += put_byte(name + length, at, bytes, valid && !reserved && is_plain_byte(at, edge));
    at += bytes;
  }
  if (!*lot) strcpy(name, WITHOUT_LOT);
  if (!*at) return;
  fg_sha256_text(lot, sum);
  snprintf(name + length, FG_LOT_FOLDER_NAME - length, "-%.*s", SUM_DIGITS, sum);
}

static fg_status check_step(fg_context *ctx, const char *path, bool make) {
  struct stat info;
  if (make && mkdir(path, 0777) != 0 && errno != EEXIST)
    return fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be made: %s", path, strerror(errno));
  if (lstat(path, &info) == 0 && S_ISDIR(info.st_mode)) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "%s: is no folder of this station", path);
}

fg_status fg_lot_folder_find(fg_context *ctx, const char *folder, const char *lot, bool make,
                             char **path) {
  char name[FG_LOT_FOLDER_NAME];
  fg_lot_folder_name(lot, name);
  FG_TRY(fg_text_print(ctx, path, "%s/" FG_LOTS_FOLDER, folder));
  fg_status status = check_step(ctx, *path, make);
  if (status == FG_OK) status = fg_text_append(ctx, path, "/%s", name);
  if (status == FG_OK) status = check_step(ctx, *path, make);
  if (status == FG_OK) return FG_OK;
  free(*path);
  *path = NULL;
  return status;
}

static void remove_files(const char *path) {
  DIR *folder = opendir(path);
  if (!folder) return;
  for (struct dirent *entry; (entry = readdir(folder));)
    unlinkat(dirfd(folder), entry->d_name, 0); /* of a folder it does nothing */
  closedir(folder);
}

fg_status fg_lot_folder_stage(fg_context *ctx, const char *folder, const char *lot, char **path) {
  char name[FG_LOT_FOLDER_NAME];
  fg_lot_folder_name(lot, name);
  FG_TRY(fg_text_print(ctx, path, "%s/" FG_LOTS_FOLDER, folder));
  fg_status status = check_step(ctx, *path, true);
  if (status == FG_OK) status = fg_text_append(ctx, path, "/.closing");
  if (status == FG_OK) status = check_step(ctx, *path, true);
  if (status == FG_OK) status = fg_text_append(ctx, path, "/%s", name);
  if (status == FG_OK) status = check_step(ctx, *path, true);
  if (status == FG_OK) remove_files(*path);
  if (status == FG_OK) return FG_OK;
  free(*path);
  *path = NULL;
  return status;
}

void fg_lot_folder_unstage(const char *staged) {
  char *parent = strdup(staged), *slash = parent ? strrchr(parent, '/') : NULL;
  remove_files(staged);
  rmdir(staged);
  if (slash) *slash = '\0';
  if (slash) rmdir(parent);
  free(parent);
}

static fg_status move_files(fg_context *ctx, DIR *from, DIR *to, const char *folder) {
  for (struct dirent *entry; (entry = readdir(from));) {
    if (entry->d_name[0] == '.') continue;
    if (renameat(dirfd(from), entry->d_name, dirfd(to), entry->d_name) != 0)
      return fg_fail(ctx, FG_ERR_IO, "%s/%s: cannot be written: %s", folder, entry->d_name,
                     strerror(errno));
  }
  fsync(dirfd(to));
  return FG_OK;
}

/* Names that the new report does not have go first: an earlier model of the scanner, beams. */
static fg_status replace_files(fg_context *ctx, const char *staged, const char *folder) {
  FG_TRY(fg_lot_remove_report(ctx, folder));
  FG_TRY(fg_lot_write_model(ctx, folder, NULL));
  DIR *from = opendir(staged), *to = opendir(folder);
  fg_status status = from && to ? move_files(ctx, from, to, folder)
                                : fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be read: %s",
                                          from ? folder : staged, strerror(errno));
  if (from) closedir(from);
  if (to) closedir(to);
  return status;
}

fg_status fg_lot_folder_publish(fg_context *ctx, const char *staged, const char *folder) {
  int lock = -1;
  FG_TRY(fg_folder_lock(ctx, folder, &lock));
  fg_status status = replace_files(ctx, staged, folder);
  close(lock);
  return status;
}
