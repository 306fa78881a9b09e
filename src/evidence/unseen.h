/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unseen causes: the uncertainty of the part's circles that is left by a smooth map
 * of the glass beside the leading model, of every size that the edges do not refute.
 *
 * A cause below detection is no cause of a size 0: on one arc a map may move the circle as a whole
 * and leave next to nothing at its edge, and beside a free form of the part it leaves nothing at
 * all. */
#ifndef FG_EVIDENCE_UNSEEN_H
#define FG_EVIDENCE_UNSEEN_H

#include "evidence/displacement.h"

/* Fills, per part of the edge fit, the second moment about the leading model's; `parts` are
 * allocated. The mean over sizes, each as likely as the next by a factor of two, by their evidence.
 */
fg_status fg_evidence_find_unseen(fg_context *ctx, fg_evidence_search *search,
                                  fg_displacement_part *parts);

#endif
