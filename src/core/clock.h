/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A clock that nobody sets. */
#ifndef FG_CORE_CLOCK_H
#define FG_CORE_CLOCK_H

/* Seconds since some moment of the past, the same one until the machine is started again. */
double fg_clock_seconds(void);

#endif
