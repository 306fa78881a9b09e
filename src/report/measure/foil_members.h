/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a foil with its bumps or beams, and of a disc. */
#ifndef FG_REPORT_MEASURE_FOIL_MEMBERS_H
#define FG_REPORT_MEASURE_FOIL_MEMBERS_H

#include "core/member.h"
#include "foilgauge/report.h"

/* A foil or a disc with the decision on it. It is object and whole of its rows' subject; the rows
 * of its bumps and beams have it as the whole. */
typedef struct fg_judged {
  const fg_design *design;
  const fg_foil *foil; /* NULL: a disc */
  const fg_disc *disc;
  fg_decision decision;
  char defect[200]; /* of a foil: what rejects it; "": nothing */
} fg_judged;

/* Rows of an fg_judged, by the kind of its foil: a strip seen from its edge; a flat foil, whose
 * beams were cut; a disc. Definitions "foil", "flat_foil" and "disc" of measure. */
extern const fg_members fg_foil_members, fg_flat_foil_members, fg_disc_members;

#endif
