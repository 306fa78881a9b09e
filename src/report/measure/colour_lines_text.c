/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "foilgauge/words.h"
#include "report/measure/colour_lines_report.h"

static void put_shift(FILE *out, const fg_colour_shift *shift) {
  fprintf(out, "%s ", fg_channel_word(shift->channel));
  switch (shift->state) {
  case FG_COLOUR_MEASURED:
    fprintf(out, "dx %+.3f ± %.3f, dy %+.3f ± %.3f px%s", shift->dx_px,
            FG_COVERAGE_FACTOR * shift->u_dx_px, shift->dy_px, FG_COVERAGE_FACTOR * shift->u_dy_px,
            shift->p_constant < FG_COLOUR_UNEVEN_P ? ", uneven along y" : "");
    break;
  case FG_COLOUR_IDENTICAL:
    fputs("is the same picture", out);
    break;
  case FG_COLOUR_NO_CONTRAST:
    fputs("shows no edges", out);
    break;
  case FG_COLOUR_FEW_EDGES:
    fputs("shows too few edges", out);
    break;
  }
}

void fg_text_colour_lines(FILE *out, const fg_measurement *measurement) {
  const fg_colour_lines *lines = &measurement->colour_lines;
  if (!lines->seen) return;
  fprintf(out, "Colour lines against %s: ", fg_channel_word(lines->against));
  put_shift(out, &lines->shifts[0]);
  fputs("; ", out);
  put_shift(out, &lines->shifts[1]);
  fputs(lines->apart ? ". APART: measure one channel, do not average them or convert to gray.\n"
                     : ".\n",
        out);
}
