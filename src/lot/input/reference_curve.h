/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The curve that a lot's errors per bump are drawn against: of a simulation, or of a die. */
#ifndef FG_LOT_INPUT_REFERENCE_CURVE_H
#define FG_LOT_INPUT_REFERENCE_CURVE_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/lot.h"

/* "reference_curve": the path of a CSV beside the recipe, or what fg_reference_curve_write writes:
 * the numbers stand in the lot's own recipe, so that it can be reported anew without the file. */
fg_status fg_reference_curve_read(fg_context *ctx, const char *path, const cJSON *value,
                                  fg_lot_settings *settings);

/* Nothing where there is none. */
void fg_reference_curve_write(fg_json *json, const char *name, const fg_lot_settings *settings);

/* Its bumps are those of the design. */
fg_status fg_reference_curve_check(fg_context *ctx, const fg_lot_settings *settings);

#endif
