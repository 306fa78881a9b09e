/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version of the library that is linked. */
#ifndef FOILGAUGE_VERSION_H
#define FOILGAUGE_VERSION_H

#ifdef __cplusplus
extern "C" {
#endif

const char *fg_version(void); /* "0.1.0" */

#ifdef __cplusplus
}
#endif
#endif
