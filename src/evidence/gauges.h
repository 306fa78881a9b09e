/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Discs of known radius: what a scanner does to sizes shows on them as far as the gauges, and the
 * level of the edges, are known. */
#ifndef FG_EVIDENCE_GAUGES_H
#define FG_EVIDENCE_GAUGES_H

#include "evidence/model.h"

/* Adds the columns of known radii and of the edges' common level, next to those of the scatter. */
fg_status fg_evidence_add_gauges(fg_context *ctx, fg_evidence_search *search);

#endif
