/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Start of the process: standard input, output and error, and the stack, as every command may rely
 * on them. */
#ifndef FG_CLI_STANDARD_H
#define FG_CLI_STANDARD_H

#include <stdbool.h>

/* Call it first: a descriptor that is closed at the start would be given to the next file that
 * is opened, and messages would land there. From here on `stderr` passes no control characters
 * but newline and tab; the progress bar (progress.h) writes to the descriptor. At exit, standard
 * output is flushed; where that fails, the program says so and ends with the exit code of
 * output. Exit does not wait for libraries to end. */
void fg_standard_start(void);

/* Reserves the first thread's stack, as large as a worker's. It grows with its use; where the
 * address space is limited (ulimit -v) it could not later, and a signal would end the program in
 * its work. False: there is not enough memory. Call it before there is another thread. */
bool fg_stack_reserve(void);

#endif
