/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The effects of a set, fitted together: each was fitted before those that joined later. */
#ifndef FG_EVIDENCE_REFIT_H
#define FG_EVIDENCE_REFIT_H

#include "evidence/model.h"

fg_status fg_evidence_refit_model(fg_context *ctx, fg_evidence_search *search,
                                  fg_evidence_model *model);

#endif
