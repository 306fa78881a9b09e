/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the colour lines of the scans say of an effect of the carriage.
 *
 * The loop finds an effect in the residuals of one channel, where geometry, optics and part have
 * their say too. Between two channels of one scan all of these are gone: a line that lies a gap g
 * ahead of the one that was measured sees the carriage's error D of y + g, so its course of dy
 * along y must be D(y) - D(y + g) beside a constant, which the scanner takes out as it puts the
 * rows together. That is a second, independent look at the same carriage.
 */
#ifndef FG_SCAN_LOOP_CHANNEL_CHECK_H
#define FG_SCAN_LOOP_CHANNEL_CHECK_H

#include "foilgauge/scan_result.h"

struct fg_scan_loop;

/* Witnesses of the claims, and of a tie what they say of it, into the result. Its claims stand. */
void fg_scan_loop_check_channels(const struct fg_scan_loop *loop, fg_scan_result *result);

#endif
