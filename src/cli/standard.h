/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Standard input, output and error as every command may rely on them. */
#ifndef FG_CLI_STANDARD_H
#define FG_CLI_STANDARD_H

/* First of all: a descriptor that is closed at the start would be given to the next file that is
 * opened, and what is said to it would land there. From here on, whatever goes to `stderr` comes
 * without control characters but newline and tab; what draws (progress.h) writes to the descriptor.
 * At exit, standard output is flushed; where that fails, the program says so and ends with the exit
 * code of output. No library's own ending is waited for. */
void fg_standard_start(void);

#endif
