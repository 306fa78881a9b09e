/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reference curve over the errors per bump, from a simulation or a die. */
#ifndef FG_LOT_INPUT_REFERENCE_CURVE_H
#define FG_LOT_INPUT_REFERENCE_CURVE_H

#include "core/member_read.h"
#include "foilgauge/lot.h"

/* Reads "reference_curve": the path of a CSV file beside the recipe, or the object that
 * the members below have. The numbers stand in the lot's own recipe, so that it can be
 * reported again without the file. */
fg_member_reader fg_reference_curve_read;

/* Of an fg_lot_curve, as recipe and report have it. */
extern const fg_members fg_reference_curve_members;

/* Checks that the design has the curve's bumps. */
fg_status fg_reference_curve_check(fg_context *ctx, const fg_lot_settings *settings);

#endif
