/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file that cannot be written is an error with words, and leaves nothing behind. */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/file.h"
#include "core/sha256.h"
#include "core/temporary.h"
#include "support/folder.h"
#include "support/test.h"

/* More than stdio buffers, so that a write fails before the commit. */
static fg_status write_much(fg_context *ctx, const char *path) {
  fg_output output;
  FG_TRY(fg_output_open(ctx, path, &output));
  for (int i = 0; i < 100000; i++)
    fputs("0123456789", output.stream);
  return fg_output_commit(ctx, &output);
}

static fg_status write_little(fg_context *ctx, const char *path) {
  fg_output output;
  FG_TRY(fg_output_open(ctx, path, &output));
  fputs("0123456789", output.stream);
  return fg_output_commit(ctx, &output);
}

static void full_device_is_an_error(void **state) {
  (void)state;
  if (access("/dev/full", W_OK) != 0) skip();
  fg_context ctx = {0};
  assert_status(&ctx, write_much(&ctx, "/dev/full"), FG_ERR_IO);
  assert_has(ctx.message, "/dev/full: cannot be written: No space left on device");
  assert_has(ctx.message, "free some space");
  assert_status(&ctx, write_little(&ctx, "/dev/full"), FG_ERR_IO);
  assert_has(ctx.message, "No space left");
}

static void full_disk_leaves_the_old_file(void **state) {
  folder *where = *state;
  write_file(where->file, "old");
  struct rlimit before, low;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  low = (struct rlimit){.rlim_cur = 5, .rlim_max = before.rlim_max};
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  fg_context much = {0}, little = {0};
  fg_status much_status = write_much(&much, where->file);
  fg_status little_status = write_little(&little, where->file);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  assert_status(NULL, much_status, FG_ERR_IO);
  assert_status(NULL, little_status, FG_ERR_IO);
  assert_has(much.message, where->file);
  assert_has(much.message, "too large");
  assert_has(little.message, "too large");
  assert_content(where->file, "old");
  assert_int_equal(count_entries(where), 1);
}

/* Space that comes back before the commit does not bring back the lost bytes. */
static void passing_shortage_is_an_error(void **state) {
  folder *where = *state;
  struct rlimit before, low;
  fg_context ctx = {0};
  fg_output output;
  assert_ok(&ctx, fg_output_open(&ctx, where->file, &output));
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  low = (struct rlimit){.rlim_cur = 5, .rlim_max = before.rlim_max};
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  for (int i = 0; i < 100000; i++)
    fputs("0123456789", output.stream);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  assert_status(&ctx, fg_output_commit(&ctx, &output), FG_ERR_IO);
  assert_has(ctx.message, where->file);
  assert_has(ctx.message, "too large");
  assert_int_equal(count_entries(where), 0);
}

static void unwritable_places_are_named(void **state) {
  folder *where = *state;
  char inside[300], missing[300];
  snprintf(missing, sizeof missing, "%s/none/report.json", where->path);
  snprintf(inside, sizeof inside, "%s/report.json", where->file);
  write_file(where->file, "x");
  const struct {
    const char *path;
    fg_status status;
    const char *says;
  } cases[] = {
      {where->path, FG_ERR_IO, "folder"},
      {missing, FG_ERR_IO, "create its folder"},
      {inside, FG_ERR_IO, "is a file, not a folder"},
      {"", FG_ERR_USAGE, "empty name"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_output output;
    assert_int_equal(fg_output_open(&ctx, cases[i].path, &output), cases[i].status);
    if (!strstr(ctx.message, cases[i].says)) fail_msg("%s", ctx.message);
    assert_null(output.stream);
    fg_output_discard(&output);
  }
  assert_int_equal(count_entries(where), 1);
}

static void read_only_file_is_respected(void **state) {
  folder *where = *state;
  write_file(where->file, "keep");
  chmod(where->file, 0444);
  if (access(where->file, W_OK) == 0) skip(); /* root may write all */
  fg_context ctx = {0};
  fg_output output;
  assert_status(&ctx, fg_output_open(&ctx, where->file, &output), FG_ERR_IO);
  assert_has(ctx.message, "ermission");
  assert_content(where->file, "keep");
}

static void standard_output_stays_open(void **state) {
  folder *where = *state;
  fg_output output;
  fflush(stdout);
  int kept = dup(STDOUT_FILENO);
  int descriptor = open(where->file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  assert_int_equal(dup2(descriptor, STDOUT_FILENO), STDOUT_FILENO);
  fg_status first = fg_output_open(NULL, "-", &output);
  fputs("one", output.stream);
  fg_status committed = fg_output_commit(NULL, &output);
  fg_status second = fg_output_open(NULL, NULL, &output);
  fputs("never", output.stream);
  fg_output_discard(&output);
  ssize_t put = write(STDOUT_FILENO, " two", 4);
  dup2(kept, STDOUT_FILENO);
  close(kept);
  close(descriptor);
  assert_ok(NULL, first);
  assert_ok(NULL, committed);
  assert_ok(NULL, second);
  assert_int_equal(put, 4);
  assert_content(where->file, "one two");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(full_device_is_an_error), WITH_FOLDER(full_disk_leaves_the_old_file),
      WITH_FOLDER(passing_shortage_is_an_error), WITH_FOLDER(unwritable_places_are_named),
      WITH_FOLDER(read_only_file_is_respected),  WITH_FOLDER(standard_output_stays_open),
  };
  return cmocka_run_group_tests_name("file, refused", tests, NULL, NULL);
}
