/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of a scan command that are known to spoil a scan. */
#ifndef FG_STATION_SCAN_OPTIONS_H
#define FG_STATION_SCAN_OPTIONS_H

#include <stddef.h>

/* Number of options of a shell command that spoil a scan, with a sentence for each: the option,
 * what it does to the scan, what to write instead. What a variable of the shell holds is not known,
 * and not told. */
size_t fg_scan_options_inspect(const char *command, char *words, size_t size);

#endif
