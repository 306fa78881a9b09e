/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of several models' columns with those of all options, in one pass over the columns:
 * these are more than the processor's caches hold. */
#ifndef FG_EVIDENCE_PRODUCTS_AHEAD_H
#define FG_EVIDENCE_PRODUCTS_AHEAD_H

#include "evidence/model.h"

/* Returns true for an option that may join a model. */
typedef bool fg_evidence_may_join(const fg_evidence_model *model, const fg_evidence_option *option);

/* With options that may join one of the models; `named`: with those that bear a name alone. */
fg_status fg_evidence_find_products_ahead(fg_context *ctx, fg_evidence_search *search,
                                          const fg_evidence_model *const *models, size_t count,
                                          bool named, fg_evidence_may_join *may_join);

#endif
