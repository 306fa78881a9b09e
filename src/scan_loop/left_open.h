/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions that a verdict by evidence leaves open. */
#ifndef FG_SCAN_LOOP_LEFT_OPEN_H
#define FG_SCAN_LOOP_LEFT_OPEN_H

#include "evidence/verdict.h"

/* Returns true where the likeliest explanation has so many numbers that some of them stay open. */
bool fg_scan_loop_is_loose(const fg_evidence_verdict *verdict);

/* Returns true where the edges do not tell whether the scanner or the foil does it. */
bool fg_scan_loop_is_split_open(const fg_edge_fit *edge_fit, const fg_evidence_verdict *verdict);

/* Returns true where one scan shows the scanner beside a free form of the foil. */
bool fg_scan_loop_is_beside_foil_field(const fg_edge_fit *edge_fit,
                                       const fg_evidence_verdict *verdict);

#endif
