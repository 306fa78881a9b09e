/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The circle of one round feature, its uncertainty and its roundness.
 *
 * A full turn tells its own noise. The residuals' harmonics 2 and up are its spectrum. The
 * spectrum's level at the lowest harmonics is the variance of radius (harmonic 0) and centre
 * (harmonic 1), whatever the correlation of neighbours. Deviations from roundness count as such
 * noise as well.
 */
#ifndef FG_GEOMETRY_DISC_FIT_H
#define FG_GEOMETRY_DISC_FIT_H

#include "foilgauge/foil.h"

/* Measures disc->stations, which were moved, again; members that do not come from the circle stay.
 */
fg_status fg_disc_measure_again(fg_context *ctx, fg_disc *disc);

/* Peak to valley of a closed radial deviation after the Gaussian filter of 50 undulations per
 * revolution (ISO 12181-2, ISO 16610-21), its first harmonic removed. Noise of sd u per value
 * raises the peak to valley. Its mean contribution is subtracted, and its scatter is the
 * uncertainty (both by simulation with a fixed seed). Unit of the values. */
fg_status fg_roundness(fg_context *ctx, const double *values, size_t count, double u,
                       double *roundness, double *u_roundness);

#endif
