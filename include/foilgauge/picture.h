/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a picture: the effects of a scanner's driver and of the light, found from its pixels.
 *
 * A length between two edges of opposite sense (a strip's thickness, a disc's diameter) depends on
 * the level at which an edge is placed: half of the light between both sides. An unknown tone curve
 * T puts that level at T(1/2) instead. An error of q of the contrast moves an edge of blur s by q s
 * sqrt(2 pi), outwards on both sides of a strip; its middle stays.
 */
#ifndef FOILGAUGE_PICTURE_H
#define FOILGAUGE_PICTURE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Findings. JSON has the words among the flags of foils and discs, and in `picture`. */
typedef enum fg_picture_finding {
  FG_PICTURE_FEW_LEVELS = 1u << 0,  /* "few_levels": fewer gray levels than noise and blur need */
  FG_PICTURE_LEVEL_GAPS = 1u << 1,  /* "level_gaps": a tone curve after rounding leaves gaps */
  FG_PICTURE_CLIPPED = 1u << 2,     /* "clipped_levels": an end of the scale cuts an edge */
  FG_PICTURE_SHARPENED = 1u << 3,   /* "sharpened": overshoot beside the edges */
  FG_PICTURE_TONE_CURVE = 1u << 4,  /* "tone_curve": one that is not a power of the light */
  FG_PICTURE_BLOCK_NOISE = 1u << 5, /* "block_noise": it once was a JPEG */
  FG_PICTURE_UNEVEN_BLUR = 1u << 6, /* "uneven_blur": along x and y, or any two axes */
  FG_PICTURE_CORRELATED_NOISE = 1u << 7, /* "correlated_noise": resampled or smoothed */
  FG_PICTURE_SHADOW = 1u << 8,           /* "shadow": beside edges of some directions */
  FG_PICTURE_ROW_JUMPS = 1u << 9,        /* "row_jumps": rows lost, doubled or shifted */
  FG_PICTURE_CHANNEL_SCALE = 1u << 10,   /* "channel_scale": channels of unequal magnification */
  FG_PICTURE_SHADING = 1u << 11,         /* "shading": the light changes much over the picture */
  FG_PICTURE_UNKNOWN_PROFILE = 1u << 12, /* "edge_profile": an edge that no model here explains */
} fg_picture_finding;

/* Number of bearings at which a shadow is stored, evenly from x towards y. */
enum { FG_PICTURE_BEARINGS = 24 };

/* NaN: not known. Shares are of the contrast where no other unit is stated. */
typedef struct fg_picture_state {
  double gray_levels;               /* in use, of 8 bits */
  double missing_levels;            /* share of those between the ends in use that are empty */
  double clipped_low, clipped_high; /* share of the edges' pixels at either end of the scale */
  double undershoot, overshoot;     /* beyond the dark and the bright level beside edges */
  double block_noise; /* steps across multiples of 8 px over those elsewhere, less 1 */
  int block_quality;  /* of the JPEG whose blocks it shows, 1 to 100; 0: not known, or none */
  double blur_px[2];  /* sd along the axis of max and of min blur */
  double blur_direction_deg;             /* of the first, from x towards y, 0 to 180 */
  double noise;                          /* sd of a pixel, counts of 255 */
  double noise_correlation[2];           /* to the next pixel along x and along y */
  double shadow;                         /* deepest band beside edges of one bearing */
  double shadow_direction_deg;           /* bearing of those edges' outward normals, x towards y */
  double shadow_at[FG_PICTURE_BEARINGS]; /* its depth by that bearing; 0: no shadow is found */
  double row_jumps, row_jump_px;         /* places where rows jump, and the largest jump */
  double shading;                        /* range of the background over the picture */
  double gamma, u_gamma;                 /* exponent of the tone curve that the edges show */
  double tone_s;                         /* S-shaped part of it: (slope at the middle) - 1 */
  double sharpen_amount, sharpen_radius_px; /* of the unsharp mask that explains the overshoot */
  double level, u_level;                    /* T(1/2) minus the model's, and its sd */
  double u_cut;      /* of the level: by edges that the ends of the scale may have cut off */
  double seen_blur;  /* of edges, over the min blur of a scanner's optics; at most 1 */
  bool level_known;  /* by a gauge or a scanner's model: u_level is its whole uncertainty */
  unsigned findings; /* fg_picture_finding */
} fg_picture_state;

/* Returns a state of NaN without findings. */
fg_picture_state fg_picture_unknown(void);

/* Merges two states: the worse of both, member by member, and the findings of both. */
void fg_picture_merge(fg_picture_state *state, const fg_picture_state *other);

/* Words of a finding: for people, and the settings of a scanner's driver that cause it. */
typedef struct fg_picture_words {
  unsigned finding;
  const char *name;               /* in JSON and CSV */
  const char *meaning;            /* effect on the numbers */
  const char *cure;               /* remedy */
  const char *sane, *twain, *wia; /* settings by name; "": none */
} fg_picture_words;

/* Ends with a row whose name is NULL. */
const fg_picture_words *fg_picture_finding_words(void);

/* Returns the finding for which a scan is no source of its scanner's model; NULL: none. */
const fg_picture_words *fg_picture_spoils_model(unsigned findings);

/* One member of the state, for JSON, page and terminal. */
typedef struct fg_picture_member {
  const char *name, *unit, *words;
  size_t offset;
  int decimals;
} fg_picture_member;

/* Ends with a row whose name is NULL. */
const fg_picture_member *fg_picture_members(void);

#ifdef __cplusplus
}
#endif
#endif
