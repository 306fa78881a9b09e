/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Room on the stack of the first thread. */
#ifndef FG_CLI_STACK_H
#define FG_CLI_STACK_H

#include <stdbool.h>

/* The first thread's stack grows as it is used; where the address space is limited (ulimit -v) it
 * then cannot, and the program is ended by a signal somewhere in its work. This takes at the start
 * what a worker's stack has. False: there is not so much memory. Call it before there is another
 * thread. */
bool fg_stack_reserve(void);

#endif
