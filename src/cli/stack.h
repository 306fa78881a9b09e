/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Room on the stack of the first thread. */
#ifndef FG_CLI_STACK_H
#define FG_CLI_STACK_H

#include <stdbool.h>

/* Reserves the first thread's stack, as large as a worker's. It grows with its use; where the
 * address space is limited (ulimit -v) it could not later, and a signal would end the program in
 * its work. False: there is not enough memory. Call it before there is another thread. */
bool fg_stack_reserve(void);

#endif
