/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version of the library that is linked. */
#ifndef FOILGAUGE_VERSION_H
#define FOILGAUGE_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

/* Returns "0.1.0" and the like. */
const char *fg_version(void);

#ifdef __cplusplus
}
#endif
#endif
