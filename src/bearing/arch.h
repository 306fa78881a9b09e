/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts common to the models of a bump's stiffness. */
#ifndef FG_BEARING_ARCH_H
#define FG_BEARING_ARCH_H

#include "foilgauge/bearing.h"

/* FG_ERR_DATA for impossible values. */
fg_status fg_arch_check(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material);

/* phi, radians. */
double fg_arch_half_angle(const fg_arch *arch);

/* D = E t³ / (12 (1 - nu²)), N mm. */
double fg_arch_bending(const fg_arch *arch, const fg_arch_material *material);

#endif
