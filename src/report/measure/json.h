/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the measure report as JSON, for reports that embed them. */
#ifndef FG_REPORT_MEASURE_JSON_H
#define FG_REPORT_MEASURE_JSON_H

#include "core/json_writer.h"
#include "foilgauge/report.h"

/* Writes "in_tolerance", true only for a pass, null where nothing is judged; and "verdict". */
void fg_json_verdict(fg_json *json, fg_verdict verdict);

/* Writes "judgements" of values; `owner` names the part that their numbers count: "bump",
 * "disc". */
void fg_json_judgements(fg_json *json, const fg_decision *decision, const char *owner);

/* Write one member of `foils`, of `discs`. */
fg_status fg_json_foil(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_foil *foil);
fg_status fg_json_disc(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_disc *disc);

#endif
