/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into the program: from the write of a given number on, the disk is full.
 *
 * FOILGAUGE_FULL_AT=N: the Nth write to a regular file and all those after it fail with ENOSPC;
 * with FOILGAUGE_FULL_ONCE only the Nth does. 0: none, and their number goes to standard error at
 * the end. What makes a file longer counts as a write; standard streams do not.
 */
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_long counted;
static long full_at;
static int full_once;

__attribute__((constructor)) static void begin(void) {
  const char *text = getenv("FOILGAUGE_FULL_AT");
  full_at = text ? atol(text) : 0;
  full_once = getenv("FOILGAUGE_FULL_ONCE") != NULL;
}

static void say(void) {
  if (!full_at) fprintf(stderr, "writes: %ld\n", atomic_load(&counted));
}

__attribute__((destructor)) static void end(void) {
  say();
}

/* The program leaves by this, past all destructors. */
_Noreturn void _exit(int code) {
  say();
  for (;;)
    syscall(SYS_exit_group, code);
}

static int is_full(int file) {
  struct stat about;
  if (file <= STDERR_FILENO || fstat(file, &about) != 0 || !S_ISREG(about.st_mode)) return 0;
  long number = atomic_fetch_add(&counted, 1) + 1;
  if (!full_at || (full_once ? number != full_at : number < full_at)) return 0;
  errno = ENOSPC;
  return 1;
}

static void *next(const char *name) {
  return dlsym(RTLD_NEXT, name);
}

ssize_t write(int file, const void *bytes, size_t size) {
  ssize_t (*real)(int, const void *, size_t) = NULL;
  *(void **)&real = next("write");
  return is_full(file) ? -1 : real(file, bytes, size);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t at) {
  ssize_t (*real)(int, const void *, size_t, off_t) = NULL;
  *(void **)&real = next("pwrite");
  return is_full(file) ? -1 : real(file, bytes, size, at);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off64_t at) {
  ssize_t (*real)(int, const void *, size_t, off64_t) = NULL;
  *(void **)&real = next("pwrite64");
  return is_full(file) ? -1 : real(file, bytes, size, at);
}

int ftruncate(int file, off_t size) {
  int (*real)(int, off_t) = NULL;
  *(void **)&real = next("ftruncate");
  return is_full(file) ? -1 : real(file, size);
}

int ftruncate64(int file, off64_t size) {
  int (*real)(int, off64_t) = NULL;
  *(void **)&real = next("ftruncate64");
  return is_full(file) ? -1 : real(file, size);
}

int posix_fallocate(int file, off_t from, off_t size) {
  int (*real)(int, off_t, off_t) = NULL;
  *(void **)&real = next("posix_fallocate");
  return is_full(file) ? ENOSPC : real(file, from, size);
}

int fsync(int file) {
  int (*real)(int) = NULL;
  *(void **)&real = next("fsync");
  return is_full(file) ? -1 : real(file);
}

int fdatasync(int file) {
  int (*real)(int) = NULL;
  *(void **)&real = next("fdatasync");
  return is_full(file) ? -1 : real(file);
}
