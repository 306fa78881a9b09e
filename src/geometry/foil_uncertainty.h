/* What a foil's values are uncertain by. */
#ifndef FG_GEOMETRY_FOIL_UNCERTAINTY_H
#define FG_GEOMETRY_FOIL_UNCERTAINTY_H

#include "geometry/layout.h"

/* Standard uncertainty of a line's place along its normal, as a share of the blur: what the
 * intensity model leaves on clean renders (reports/accuracy.md). */
#define FG_LINE_SHIFT_BLURS 0.001

/* Covariances of the overall circle and of every bump's; noise and edge model of the foil. */
fg_status fg_foil_find_uncertainties(fg_context *ctx, fg_layout *layout, fg_foil *foil);

/* The same of a plain strip: its circle's covariance, noise, roughness of the edges. */
void fg_foil_find_arc_uncertainty(fg_layout *layout, fg_foil *foil);

/* What moves both edges outwards or inwards, as u of their distance: the tone curve alone; with
 * what the scan has lost. */
double fg_foil_tone_doubt_um(const fg_foil *foil);
double fg_foil_width_doubt_um(const fg_foil *foil);

/* Its share of the thickness' uncertainty. */
void fg_foil_add_width_doubt(fg_foil *foil);

/* The strip's thickness in units of the edges' blur. */
double fg_foil_widths_in_blurs(const fg_foil *foil);

#endif
