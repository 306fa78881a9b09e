/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dots per inch of a scan: as its file or the caller says. */
#ifndef FG_SCAN_RESOLUTION_H
#define FG_SCAN_RESOLUTION_H

#include "foilgauge/scan.h"
#include "scan/header.h"

/* Fills dpi and dpi_file of `info`. `dpi` 0 is "as the file says". Errors as fg_scan_open's. */
fg_status fg_resolution_find(fg_context *ctx, const char *name, const fg_scan_header *header,
                             double dpi, fg_scan_info *info);

#endif
