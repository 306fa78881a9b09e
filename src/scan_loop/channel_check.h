/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Check of an effect of the carriage by the colour lines of the scans.
 *
 * The loop finds an effect in the residuals of one channel, which geometry, optics and part
 * influence too. Between two channels of one scan these cancel. A line that lies a gap g ahead of
 * the measured one sees the carriage's error D of y + g, so its difference dy along y must be D(y)
 * - D(y + g), up to a constant that the scanner removes when it aligns the rows. It is an
 * independent test of the same carriage. */
#ifndef FG_SCAN_LOOP_CHANNEL_CHECK_H
#define FG_SCAN_LOOP_CHANNEL_CHECK_H

#include "foilgauge/scan_result.h"

struct fg_scan_loop;

/* Adds the channel checks of the claims, and for a tie their words, to the result. The claims stay.
 */
void fg_scan_loop_check_channels(const struct fg_scan_loop *loop, fg_scan_result *result);

#endif
