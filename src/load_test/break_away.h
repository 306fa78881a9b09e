/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Break-away tests: torque at which a rotor begins to turn, over the dead weight on its bearing. */
#ifndef FG_LOAD_TEST_BREAK_AWAY_H
#define FG_LOAD_TEST_BREAK_AWAY_H

#include "foilgauge/load_test.h"

/* Reads the options' break-away tests, after the tests: files, bearings, pulls. */
fg_status fg_break_away_read(fg_context *ctx, fg_load_test *test);

#endif
