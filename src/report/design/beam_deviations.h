/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deviations of a beam's length and width whose consequences `foilgauge design` lists. */
#ifndef FG_REPORT_BEAM_DEVIATIONS_H
#define FG_REPORT_BEAM_DEVIATIONS_H

enum { FG_BEAM_DEVIATIONS = 4 };

/* In percent of the design: 1 % of either alone, then those of the beams in thesis section 5.11,
 * with the signs that add up in the compliance (it prints +-3.56 %). */
static const double fg_beam_deviations_pct[FG_BEAM_DEVIATIONS][2] = {
    {1, 0}, {0, 1}, {0.44, -2.19}, {-0.44, 2.19}};

#endif
