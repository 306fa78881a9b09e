/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GSL set up for a library: errors come back as codes, never as an abort. */
#ifndef FG_CORE_NUMERICS_H
#define FG_CORE_NUMERICS_H

#ifdef __cplusplus
extern "C" {
#endif

/* Call before any GSL function; it may be called from several threads and more than once. */
void fg_numerics_start(void);

#ifdef __cplusplus
}
#endif
#endif
