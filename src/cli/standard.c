/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/standard.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "foilgauge/file.h"
#include "foilgauge/text.h"

/* Opens closed descriptors on /dev/null, for input and output the wrong way round: output that
 * would be lost is then an error. */
static void open_closed(void) {
  static const int modes[] = {O_WRONLY, O_RDONLY, O_WRONLY};
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; descriptor++)
    if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", modes[descriptor]) != descriptor)
      _exit(fg_status_exit_code(FG_ERR_IO));
}

/* Ends the program without the libraries' exit handlers, which can wait for ever: OpenBLAS does,
 * where address space was too small for its threads. Nothing of ours is left to do.
 * LeakSanitizer runs after this, so a program with sanitizers ends the long way. */
static void leave(int code) {
#ifndef __SANITIZE_ADDRESS__
  fflush(NULL);
  _exit(code);
#else
  (void)code;
#endif
}

static void flush_output(int code, void *unused) {
  fg_context ctx;
  (void)unused;
  errno = 0;
  if (fflush(stdout) == 0 && !ferror(stdout)) {
    leave(code);
    return;
  }
  fg_status status = fg_output_fail(&ctx, "standard output", errno ? errno : EIO);
  fprintf(stderr, "foilgauge: %s\n", ctx.message);
  _exit(fg_status_exit_code(status));
}

/* Messages may hold names and texts from files; no control character of those reaches a terminal
 * or a log. */
static ssize_t write_visible(void *unused, const char *bytes, size_t size) {
  enum { PIECE = 1024 };
  char visible[4 * PIECE];
  (void)unused;
  for (size_t at = 0; at < size;) {
    size_t length, piece = size - at < PIECE ? size - at : PIECE;
    at += fg_utf8_make_visible(bytes + at, piece, at + piece == size, visible, &length);
    if (write(STDERR_FILENO, visible, length) < 0) return 0;
  }
  return (ssize_t)size;
}

static void filter_errors(void) {
  static const cookie_io_functions_t functions = {.write = write_visible};
  FILE *stream = fopencookie(NULL, "w", functions);
  if (!stream) return;
  setvbuf(stream, NULL, _IONBF, 0);
  stderr = stream;
}

void fg_standard_start(void) {
  /* Help texts are written at once, so that a write that fails is the one whose errno is there. */
  static char buffer[1 << 16];
  open_closed();
  if (!isatty(STDOUT_FILENO)) setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
  on_exit(flush_output, NULL);
  filter_errors();
}

/* SLACK: the stack in use already, and the gap below it. */
enum { RESERVED_BYTES = 2 << 20, SLACK_BYTES = 1 << 17 };

static __attribute__((noinline)) void touch_far_end(void) {
  char block[RESERVED_BYTES];
  __asm__ volatile("" : : "r"(block) : "memory"); /* it is there, for all that the compiler knows */
  *(volatile char *)block = 0;
}

bool fg_stack_reserve(void) {
  struct rlimit stack;
  if (getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < 2 * RESERVED_BYTES) return true;
  /* Growing would be fatal where it fails; asking for as much is not. */
  void *probe = mmap(NULL, RESERVED_BYTES + SLACK_BYTES, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED) return false;
  munmap(probe, RESERVED_BYTES + SLACK_BYTES);
  touch_far_end();
  return true;
}
