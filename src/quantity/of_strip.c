/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of a traced strip: the scan's state, not the part's. */
#include <stddef.h>

#include "quantity/rows.h"

static const fg_quantity rows[] = {
    {.name = "stations",
     .unit = "",
     .symbol = "n",
     .words = "cross-sections along the strip",
     .kind = FG_QUANTITY_COUNT,
     FG_AT(fg_strip, count)},
    {.name = "step_mm",
     .unit = "mm",
     .symbol = "step",
     .words = "nominal distance of the cross-sections",
     FG_AT(fg_strip, step_mm),
     .decimals = 4},
    {.name = "blur_left_um",
     .unit = "µm",
     .symbol = "blur left",
     .words = "blur of the left edge, standard deviation",
     FG_AT(fg_strip, blur_left_um),
     .decimals = 1},
    {.name = "blur_right_um",
     .unit = "µm",
     .symbol = "blur right",
     .words = "blur of the right edge, standard deviation",
     FG_AT(fg_strip, blur_right_um),
     .decimals = 1},
    {.name = "contrast",
     .unit = "",
     .symbol = "contrast",
     .words = "strip minus background, in units of the scan's full scale",
     FG_AT(fg_strip, contrast),
     .decimals = 3},
    {.name = "noise",
     .unit = "",
     .symbol = "noise",
     .words = "standard deviation of a pixel, in units of the scan's full scale",
     FG_AT(fg_strip, noise),
     .decimals = 4},
    {.name = "gamma",
     .unit = "",
     .symbol = "γ",
     .words = "exponent of the tone curve",
     FG_AT(fg_strip, gamma),
     .decimals = 3},
};

const fg_quantity_rows fg_quantities_of_strip = FG_QUANTITY_ROWS(rows);
