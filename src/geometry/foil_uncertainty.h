/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainties of a foil's values. */
#ifndef FG_GEOMETRY_FOIL_UNCERTAINTY_H
#define FG_GEOMETRY_FOIL_UNCERTAINTY_H

#include "geometry/layout.h"

/* Standard uncertainty of a line's place along its normal, as a share of the blur: the intensity
 * model's error on clean renders (reports/accuracy.md). */
#define FG_LINE_SHIFT_BLURS 0.001

/* Finds the covariances of the overall circle and of every bump's; noise and edge model of the
 * foil. */
fg_status fg_foil_find_uncertainties(fg_context *ctx, fg_layout *layout, const fg_design *design,
                                     fg_foil *foil);

/* Finds the uncertainties of a plain strip: its circle's covariance, noise, roughness of the edges.
 */
void fg_foil_find_arc_uncertainty(fg_layout *layout, const fg_design *design, fg_foil *foil);

/* Uncertainty of the distance of two edges that move outwards or inwards together.
 * fg_foil_tone_u_um: by the level of the edges alone, which a tone curve moves; fg_foil_width_u_um:
 * with JPEG's loss. */
double fg_foil_tone_u_um(const fg_design *design, const fg_foil *foil);
double fg_foil_width_u_um(const fg_design *design, const fg_foil *foil);

/* Uncertainty of the place of one edge, mm: by the level alone. */
double fg_foil_edge_u_mm(const fg_design *design, const fg_foil *foil);

/* Finds the strip's thickness by the scan and the one in force, their uncertainties, and the flags
 * of a thickness that contradicts the stated one or is far from the design's. The foil's flags of
 * its edges are set already. */
void fg_foil_find_thickness(const fg_design *design, fg_foil *foil);

#endif
