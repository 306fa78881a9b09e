/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Displacement by the scanner, as the mean over all models that have weight, in the form of a map:
 * what has no name corrects other scans by it. */
#ifndef FG_EVIDENCE_DISPLACEMENT_MAP_H
#define FG_EVIDENCE_DISPLACEMENT_MAP_H

#include "evidence/displacement.h"
#include "field/map.h"

/* Fills a map over the picture, and the modes of its uncertainty: of every model of the window, and
 * of these models about their mean. `about` is the displacement of fg_evidence_find_displacement,
 * which chooses the splines. No numbers (mm: NULL) where a model that has weight jumps or has a
 * scale of known sizes, or where splines do not follow the mean.
 */
fg_status fg_evidence_find_map(fg_context *ctx, fg_evidence_search *search,
                               const fg_evidence_window *window, const fg_displacement *about,
                               fg_field_map *map);

#endif
