/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the measure report, "foilgauge/measure/1", and its foils and discs for reports that
 * embed them. */
#ifndef FG_REPORT_MEASURE_MEMBERS_H
#define FG_REPORT_MEASURE_MEMBERS_H

#include "report/measure/foil_members.h"

fg_status fg_judge_foil(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                        fg_judged *judged);
fg_status fg_judge_disc(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                        fg_judged *judged);

/* Write one member of `foils`, of `discs`. */
fg_status fg_json_foil(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_foil *foil);
fg_status fg_json_disc(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_disc *disc);

extern const fg_document fg_measure_document;

#endif
