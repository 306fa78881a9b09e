/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files appear under their final name only when whole; what goes wrong is said and leaves nothing
 * behind. */
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

static void file_appears_only_when_whole(void **state) {
  folder *where = *state;
  write_file(where->file, "old");
  fg_output output;
  assert_ok(&test_context, fg_output_open(&test_context, where->file, &output));
  fputs("new", output.stream);
  fflush(output.stream);
  assert_content(where->file, "old");
  assert_int_equal(count_entries(where), 2);
  assert_ok(&test_context, fg_output_commit(&test_context, &output));
  fg_output_discard(&output);
  assert_content(where->file, "new");
  assert_int_equal(count_entries(where), 1);
}

static void discard_leaves_nothing(void **state) {
  folder *where = *state;
  fg_output output;
  assert_ok(&test_context, fg_output_open(&test_context, where->file, &output));
  fputs("half", output.stream);
  fg_output_discard(&output);
  fg_output_discard(&output);
  assert_int_equal(count_entries(where), 0);
}

static void mode_follows_the_umask(void **state) {
  folder *where = *state;
  mode_t old = umask(027);
  write_file(where->file, "x");
  umask(old);
  struct stat entry;
  assert_int_equal(stat(where->file, &entry), 0);
  assert_int_equal(entry.st_mode & 0777, 0640);
}

/* A file that few may read is not opened to all by being written again. */
static void a_replaced_file_keeps_its_mode(void **state) {
  folder *where = *state;
  struct stat entry;
  mode_t old = umask(022);
  write_file(where->file, "old");
  assert_int_equal(chmod(where->file, 0600), 0);
  write_file(where->file, "new");
  assert_int_equal(stat(where->file, &entry), 0);
  assert_int_equal(entry.st_mode & 0777, 0600);
  assert_int_equal(chmod(where->file, 0666), 0);
  write_file(where->file, "newer");
  umask(old);
  assert_int_equal(stat(where->file, &entry), 0);
  assert_int_equal(entry.st_mode & 0777, 0666);
}

static void a_replaced_file_keeps_its_owner(void **state) {
  folder *where = *state;
  struct stat entry;
  if (geteuid() != 0) skip();
  write_file(where->file, "old");
  assert_int_equal(chown(where->file, 65534, 65533), 0);
  assert_int_equal(chmod(where->file, 0640), 0);
  write_file(where->file, "new");
  assert_int_equal(stat(where->file, &entry), 0);
  assert_int_equal(entry.st_uid, 65534);
  assert_int_equal(entry.st_gid, 65533);
  assert_int_equal(entry.st_mode & 0777, 0640);
}

/* /dev/shm is a folder of files like any other. */
static void shared_memory_is_written_like_a_file(void **state) {
  (void)state;
  char path[] = "/dev/shm/foilgauge-test-XXXXXX";
  fg_output output;
  int descriptor = mkstemp(path);
  if (descriptor < 0) skip();
  close(descriptor);
  write_file(path, "old");
  assert_ok(&test_context, fg_output_open(&test_context, path, &output));
  fputs("new", output.stream);
  fflush(output.stream);
  assert_content(path, "old");
  fg_output_discard(&output);
  assert_content(path, "old");
  unlink(path);
}

/* A redirected descriptor is not a file to be replaced: others write to it as well. */
static void a_named_descriptor_is_written_in_place(void **state) {
  folder *where = *state;
  char name[40];
  int descriptor = open(where->file, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  assert_int_equal(write(descriptor, "before ", 7), 7);
  snprintf(name, sizeof name, "/dev/fd/%d", descriptor);
  write_file(name, "within");
  assert_int_equal(write(descriptor, " after", 6), 6);
  close(descriptor);
  assert_content(where->file, "before within after");
  fg_context ctx = {0};
  fg_output output;
  assert_status(&ctx, fg_output_open(&ctx, name, &output), FG_ERR_IO);
  assert_has(ctx.message, name);
}

/* Leftovers of a killed run go with the next one; files that another run is writing stay. */
static void leftovers_are_removed_and_others_kept(void **state) {
  folder *where = *state;
  fg_output one, other;
  assert_ok(&test_context, fg_output_open(&test_context, where->file, &one));
  assert_ok(&test_context, fg_output_open(&test_context, where->file, &other));
  assert_int_equal(count_entries(where), 2);
  fputs("one", one.stream);
  fputs("other", other.stream);
  assert_ok(&test_context, fg_output_commit(&test_context, &one));
  assert_content(where->file, "one");
  assert_ok(&test_context, fg_output_commit(&test_context, &other));
  assert_content(where->file, "other");
  assert_int_equal(count_entries(where), 1);

  pid_t child = fork();
  if (child == 0) {
    fg_output abandoned;
    _exit(fg_output_open(NULL, where->file, &abandoned) == FG_OK ? 0 : 1);
  }
  int code = -1;
  assert_int_equal(waitpid(child, &code, 0), child);
  assert_int_equal(code, 0);
  assert_int_equal(count_entries(where), 2);
  write_file(where->file, "next");
  assert_int_equal(count_entries(where), 1);
}

/* The end of the process removes all files on their way, and nothing appears after that. */
static void all_temporaries_go_at_once(void **state) {
  folder *where = *state;
  char second[300];
  snprintf(second, sizeof second, "%s/second", where->path);
  write_file(second, "old");
  pid_t child = fork();
  if (child == 0) {
    fg_output a, b;
    if (fg_output_open(NULL, where->file, &a) != FG_OK) _exit(1);
    if (fg_output_open(NULL, second, &b) != FG_OK) _exit(2);
    fg_temporaries_remove();
    _exit(0);
  }
  int code = -1;
  assert_int_equal(waitpid(child, &code, 0), child);
  assert_int_equal(code, 0);
  assert_int_equal(count_entries(where), 1);
  assert_content(second, "old");
}

static void symbolic_link_stays_a_link(void **state) {
  folder *where = *state;
  char link[256];
  snprintf(link, sizeof link, "%s/latest", where->path);
  write_file(where->file, "old");
  assert_int_equal(symlink("report.json", link), 0);
  write_file(link, "new");
  assert_content(where->file, "new");
  struct stat entry;
  assert_int_equal(lstat(link, &entry), 0);
  assert_true(S_ISLNK(entry.st_mode));
}

static void bare_name_goes_to_the_current_folder(void **state) {
  folder *where = *state;
  int before = open(".", O_RDONLY | O_DIRECTORY);
  assert_int_equal(chdir(where->path), 0);
  write_file("report.json", "here");
  assert_int_equal(fchdir(before), 0);
  close(before);
  assert_content(where->file, "here");
}

static void names_may_be_as_long_as_names_can_be(void **state) {
  folder *where = *state;
  char path[500];
  snprintf(path, sizeof path, "%s/%0255d", where->path, 0);
  write_file(path, "long");
  assert_content(path, "long");
}

static void text_is_read_whole(void **state) {
  folder *where = *state;
  char *text = NULL, content[20001];
  memset(content, 'a', 20000);
  content[20000] = '\0';
  write_file(where->file, content);
  assert_ok(&test_context, fg_file_read_text(&test_context, where->file, 20000, &text));
  assert_string_equal(text, content);
  free(text);
  fg_context ctx = {0};
  assert_status(&ctx, fg_file_read_text(&ctx, where->file, 19999, &text), FG_ERR_DATA);
  assert_null(text);
  assert_has(ctx.message, "19999");
  write_file(where->file, "");
  assert_content(where->file, "");
}

static void what_is_no_text_is_refused(void **state) {
  folder *where = *state;
  char *text = NULL;
  fg_context ctx = {0};
  FILE *stream = fopen(where->file, "wb");
  fwrite("ab\0cd", 1, 5, stream);
  fclose(stream);
  assert_status(&ctx, fg_file_read_text(&ctx, where->file, 100, &text), FG_ERR_DATA);
  assert_has(ctx.message, "byte 2");
  assert_status(&ctx, fg_file_read_text(&ctx, where->path, 100, &text), FG_ERR_IO);
  assert_has(ctx.message, "is a folder");
  assert_status(&ctx, fg_file_read_text(&ctx, "/nonexistent/design.json", 100, &text), FG_ERR_IO);
  assert_has(ctx.message, "/nonexistent/design.json");
  assert_null(text);
}

/* FIPS 180-2, appendix B.1: the sum of "abc". */
static void sha256_is_the_standards(void **state) {
  folder *where = *state;
  char hex[65];
  write_file(where->file, "abc");
  assert_ok(&test_context, fg_sha256_file(&test_context, where->file, hex));
  assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  assert_status(NULL, fg_sha256_file(NULL, where->path, hex), FG_ERR_IO);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(file_appears_only_when_whole),
      WITH_FOLDER(discard_leaves_nothing),
      WITH_FOLDER(mode_follows_the_umask),
      WITH_FOLDER(a_replaced_file_keeps_its_mode),
      WITH_FOLDER(a_replaced_file_keeps_its_owner),
      cmocka_unit_test(shared_memory_is_written_like_a_file),
      WITH_FOLDER(a_named_descriptor_is_written_in_place),
      WITH_FOLDER(leftovers_are_removed_and_others_kept),
      WITH_FOLDER(all_temporaries_go_at_once),
      WITH_FOLDER(symbolic_link_stays_a_link),
      WITH_FOLDER(bare_name_goes_to_the_current_folder),
      WITH_FOLDER(names_may_be_as_long_as_names_can_be),
      WITH_FOLDER(text_is_read_whole),
      WITH_FOLDER(what_is_no_text_is_refused),
      WITH_FOLDER(sha256_is_the_standards),
  };
  return cmocka_run_group_tests_name("file", tests, NULL, NULL);
}
