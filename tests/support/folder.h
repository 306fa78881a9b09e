/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of its own for a test of files, and what lies in it. */
#ifndef FG_TESTS_FOLDER_H
#define FG_TESTS_FOLDER_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "support/test.h"

typedef struct folder {
  char path[200], file[256];
} folder;

static inline int make_folder(void **state) {
  folder *made = calloc(1, sizeof *made);
  const char *parent = getenv("TMPDIR");
  snprintf(made->path, sizeof made->path, "%s/foilgauge-test-XXXXXX",
           parent && *parent ? parent : "/tmp");
  if (!mkdtemp(made->path)) return -1;
  snprintf(made->file, sizeof made->file, "%s/report.json", made->path);
  *state = made;
  return 0;
}

static inline int count_entries(const folder *where) {
  int count = 0;
  DIR *entries = opendir(where->path);
  for (struct dirent *entry; entries && (entry = readdir(entries));)
    count += strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..");
  closedir(entries);
  return count;
}

static inline int remove_folder(void **state) {
  folder *made = *state;
  DIR *entries = opendir(made->path);
  for (struct dirent *entry; entries && (entry = readdir(entries));)
    unlinkat(dirfd(entries), entry->d_name, 0);
  closedir(entries);
  int result = rmdir(made->path);
  free(made);
  return result;
}

static inline void write_file(const char *path, const char *content) {
  fg_context ctx = {0};
  fg_output output;
  if (fg_output_open(&ctx, path, &output) != FG_OK) fail_msg("%s", ctx.message);
  fputs(content, output.stream);
  if (fg_output_commit(&ctx, &output) != FG_OK) fail_msg("%s", ctx.message);
}

static inline void assert_content(const char *path, const char *content) {
  char *text = NULL;
  assert_ok(&test_context, fg_file_read_text(&test_context, path, 1000, &text));
  assert_string_equal(text, content);
  free(text);
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, make_folder, remove_folder)

#endif
