/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Labels of stations: part of the foil, and residual from the circle fitted there. */
#ifndef FG_GEOMETRY_LABELS_H
#define FG_GEOMETRY_LABELS_H

#include "geometry/layout.h"

/* Fills foil->labels; the foil's bumps are numbered already. */
fg_status fg_labels_fill(fg_context *ctx, const fg_layout *layout, fg_datum datum, fg_foil *foil);

#endif
