/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory that the C library takes from the system. */
#ifndef FG_CLI_HEAP_H
#define FG_CLI_HEAP_H

/* To be called once, before the first large allocation. */
void fg_heap_start(void);

#endif
