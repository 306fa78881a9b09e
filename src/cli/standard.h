/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Standard input, output and error as every command may rely on them. */
#ifndef FG_CLI_STANDARD_H
#define FG_CLI_STANDARD_H

/* Call it first: a descriptor that is closed at the start would be given to the next file that
 * is opened, and messages would land there. From here on `stderr` passes no control characters
 * but newline and tab; the progress bar (progress.h) writes to the descriptor. At exit, standard
 * output is flushed; where that fails, the program says so and ends with the exit code of
 * output. Exit does not wait for libraries to end. */
void fg_standard_start(void);

#endif
