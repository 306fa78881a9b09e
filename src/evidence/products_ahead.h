/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of several models' columns with those of all options, in one pass over the columns:
 * these are more than the processor's caches hold. */
#ifndef FG_EVIDENCE_PRODUCTS_AHEAD_H
#define FG_EVIDENCE_PRODUCTS_AHEAD_H

#include "evidence/model.h"

/* `named`: with those of options that bear a name alone. */
fg_status fg_evidence_find_products_ahead(fg_context *ctx, fg_evidence_search *search,
                                          const fg_evidence_model *const *models, size_t count,
                                          bool named);

#endif
