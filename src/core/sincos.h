/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FG_CORE_SINCOS_H
#define FG_CORE_SINCOS_H

#include <stddef.h>

/* Fills sine and cosine of `count` angles, rad, several at a time: within 3e-16 for angles up to
 * 1e5; beyond, as the C library has them. No array may overlap another. */
void fg_sincos(size_t count, const double *angle, double *sine, double *cosine);

#endif
