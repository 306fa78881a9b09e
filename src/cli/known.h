/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The user's knowledge of a part or a scanner, from the command line: it overrules the design. */
#ifndef FG_CLI_KNOWN_H
#define FG_CLI_KNOWN_H

#include <stdio.h>

#include "foilgauge/design.h"

struct argp_state;

typedef struct fg_cli_known {
  bool tone_given;
  fg_tone_statement tone;
  double thickness_mm, u_thickness_mm; /* 0: not given */
  bool flatbed;
} fg_cli_known;

enum { FG_CLI_TONE = 0x7002, FG_CLI_THICKNESS = 0x7003, FG_CLI_FLATBED = 0x7004 };

#define FG_CLI_FLATBED_ROW(group)                                                                  \
  {                                                                                                \
    "flatbed", FG_CLI_FLATBED, NULL, 0,                                                            \
        "Nothing is known of the scanner, a flatbed: every u holds 0.3 % of x and of y, so that "  \
        "limits can be judged",                                                                    \
        group                                                                                      \
  }

#define FG_CLI_KNOWN_ROWS(group)                                                                    \
  {"tone",                                                                                          \
   FG_CLI_TONE,                                                                                     \
   "TONE",                                                                                          \
   0,                                                                                               \
   "linear: you vouch that the scanner's counts are proportional to the light; u of thickness "     \
   "and "                                                                                           \
   "of diameters then leaves out the tone curve (default: unknown)",                                \
   group},                                                                                          \
      FG_CLI_FLATBED_ROW(group), {                                                                  \
    "thickness-measured", FG_CLI_THICKNESS, "MM±U", 0,                                              \
        "The strip's thickness by a micrometer and its standard uncertainty, as 0.1003±0.0005 or " \
        "0.1003:0.0005; clearances and stiffness use it, and the scan is held against it",          \
        group                                                                                       \
  }

/* Reads an option of these rows; false: it is another one. A wrong argument ends the program. */
bool fg_cli_parse_known(struct argp_state *state, int key, const char *text, fg_cli_known *known);

/* Writes it into the design, and notes the overruled values on standard error. Check the design
 * afterwards. */
void fg_cli_apply_known(const fg_cli_known *known, fg_design *design);

/* Applies --flatbed; FG_ERR_USAGE where the design states a calibration. */
fg_status fg_cli_apply_flatbed(fg_context *ctx, bool flatbed, fg_design *design);

/* Notes on standard error that no limit of the design is judged, and what to do. */
void fg_cli_note_scale(const fg_design *design);

/* Applies --form, which overrules the design's kind; NULL leaves it. */
fg_status fg_cli_apply_foil_kind(fg_context *ctx, const char *kind, fg_design *design);
void fg_cli_write_foil_kinds(FILE *out); /* writes "classical, sinusoidal or discs" */

#endif
