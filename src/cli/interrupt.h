/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A signal ends every command in one way: no temporary file stays, exit code 130. */
#ifndef FG_CLI_INTERRUPT_H
#define FG_CLI_INTERRUPT_H

/* Starts the watch for signals. From here on SIGINT, SIGTERM and SIGHUP (those that are not
 * ignored already: nohup) go to a thread that removes the temporary files and ends the program.
 * A reader that has gone (SIGPIPE) and a file size limit (SIGXFSZ) are write errors, and no
 * signals. Call it before there is any other thread, so that all inherit the blocked signals. */
void fg_interrupt_start(void);

/* Time for a command to end itself. */
enum { FG_INTERRUPT_SECONDS = 20 };

/* Defers the end to the command: from here on the first signal makes the returned descriptor
 * readable, and the command ends itself (with FG_ERR_INTERRUPTED). A second signal, or the time,
 * ends it as always. -1: every signal does. */
int fg_interrupt_defer(void);

#endif
