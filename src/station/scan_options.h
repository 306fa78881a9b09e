/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of a scan command that are known to spoil a scan. */
#ifndef FG_STATION_SCAN_OPTIONS_H
#define FG_STATION_SCAN_OPTIONS_H

#include <stddef.h>

/* Returns the number of options of a shell command that spoil a scan, and writes a sentence for
 * each: the option, its effect on the scan, the option to use instead. Values of shell variables
 * are not known. */
size_t fg_scan_options_inspect(const char *command, char *words, size_t size);

#endif
