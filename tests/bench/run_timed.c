/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a command and writes its cost: wall, user and system seconds, peak memory in KiB, exit
 * code. It is a small program because the peak of a child counts what its parent held at the fork:
 * measured from a Python process, every command would seem to need Python's memory.
 *
 * Usage: run_timed RESULT COMMAND [ARG...]; one line goes to the file RESULT.
 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double seconds(struct timeval t) {
  return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char **argv) {
  if (argc < 3) {
    fputs("usage: run_timed RESULT COMMAND [ARG...]\n", stderr);
    return 64;
  }
  const double start = now();
  const pid_t child = fork();
  if (child == 0) {
    execvp(argv[2], argv + 2);
    perror(argv[2]);
    _exit(127);
  }
  int status = 0;
  struct rusage usage;
  if (child < 0 || wait4(child, &status, 0, &usage) != child) {
    perror("run_timed");
    return EXIT_FAILURE;
  }
  const double wall = now() - start;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  FILE *result = fopen(argv[1], "w");
  if (!result) {
    perror(argv[1]);
    return EXIT_FAILURE;
  }
  fprintf(result, "%.6f %.6f %.6f %ld %d\n", wall, seconds(usage.ru_utime), seconds(usage.ru_stime),
          usage.ru_maxrss, code);
  return fclose(result) ? EXIT_FAILURE : EXIT_SUCCESS;
}
