/* What is found of a picture, in words, and the members of its state. */
#include "foilgauge/picture.h"

#define AT(member) offsetof(fg_picture_state, member)

static const fg_picture_words findings[] = {
    {FG_PICTURE_FEW_LEVELS, "few_levels",
     "The picture has so few gray levels that the place of an edge depends on where they lie.",
     "Scan in gray of 8 or 16 bits.", "--mode Gray --depth 16",
     "ICAP_PIXELTYPE TWPT_GRAY, "
     "ICAP_BITDEPTH 16",
     "WIA_IPA_DEPTH 16"},
    {FG_PICTURE_LEVEL_GAPS, "level_gaps",
     "Gray levels are missing between others: a tone curve was applied after rounding.",
     "Turn off tone curve, brightness and contrast; scan with 16 bits.", "", "", ""},
    {FG_PICTURE_CLIPPED, "clipped_levels", "An end of the gray scale cuts the edges' profile.",
     "Turn off automatic contrast; scan with less exposure.", "", "", ""},
    {FG_PICTURE_SHARPENED, "sharpened",
     "The edges overshoot: the driver has sharpened the picture.", "Turn sharpening off.", "", "",
     ""},
    {FG_PICTURE_TONE_CURVE, "tone_curve",
     "The driver has applied a tone curve: widths depend on its middle.",
     "Turn off automatic contrast and tone curve; scan linearly (gamma 1).", "", "", ""},
    {FG_PICTURE_BLOCK_NOISE, "block_noise",
     "Blocks of 8 × 8 pixels show: the picture once was a JPEG, which moves edges.",
     "Have the scanner write PNG or TIFF.", "", "", ""},
    {FG_PICTURE_UNEVEN_BLUR, "uneven_blur",
     "The picture is blurred more along one direction than across it.",
     "Scan at a resolution that the scanner has along both axes.", "", "", ""},
    {FG_PICTURE_CORRELATED_NOISE, "correlated_noise",
     "The noise of neighbouring pixels is alike: the driver has interpolated or smoothed.",
     "Scan at the optical resolution; turn noise reduction off.", "", "", ""},
    {FG_PICTURE_SHADOW, "shadow",
     "A shadow or the foil's wall shows beside edges of some directions, and moves them.",
     "Lay the foil flat and close the lid; turn it and scan again.", "", "", ""},
    {FG_PICTURE_ROW_JUMPS, "row_jumps",
     "Rows jump: the carriage stopped, or the picture was stitched.",
     "Scan without pauses: less resolution, a smaller window, or a faster connection.", "", "", ""},
    {FG_PICTURE_CHANNEL_SCALE, "channel_scale", "The colour channels have unequal magnification.",
     "Measure one channel (--channel green).", "--mode Gray", "ICAP_PIXELTYPE TWPT_GRAY",
     "WIA_IPA_DATATYPE grayscale"},
    {FG_PICTURE_SHADING, "shading", "The light changes much over the picture.",
     "Let the scanner calibrate; close the lid; keep stray light out.", "", "", ""},
    {FG_PICTURE_UNKNOWN_PROFILE, "edge_profile",
     "The edges' profile is none that a scanner makes of light: widths are uncertain.",
     "Turn off every improvement of the picture in the driver.", "", "", ""},
    {0, NULL, NULL, NULL, NULL, NULL, NULL},
};

static const fg_picture_member members[] = {
    {"gray_levels", "", "gray levels in use, of 8 bits", AT(gray_levels), 0},
    {"missing_levels", "", "share of the gray levels between them that are missing",
     AT(missing_levels), 3},
    {"clipped_low", "", "share of the edges' pixels at the dark end of the scale", AT(clipped_low),
     4},
    {"clipped_high", "", "share of the edges' pixels at the bright end of the scale",
     AT(clipped_high), 4},
    {"undershoot", "", "undershoot at the dark side of edges, share of the contrast",
     AT(undershoot), 4},
    {"overshoot", "", "overshoot at the bright side of edges, share of the contrast", AT(overshoot),
     4},
    {"block_noise", "", "steps across multiples of 8 px over those elsewhere, less 1",
     AT(block_noise), 3},
    {"blur_max_px", "px", "blur along the axis of most blur, standard deviation", AT(blur_px[0]),
     3},
    {"blur_min_px", "px", "blur across it, standard deviation", AT(blur_px[1]), 3},
    {"blur_direction_deg", "°", "direction of most blur, from x towards y", AT(blur_direction_deg),
     1},
    {"noise", "", "noise of a pixel, counts of 255, standard deviation", AT(noise), 3},
    {"noise_correlation_x", "", "correlation of the noise to the next pixel along x",
     AT(noise_correlation[0]), 3},
    {"noise_correlation_y", "", "correlation of the noise to the next row",
     AT(noise_correlation[1]), 3},
    {"shadow", "", "band beside the edges of one direction, share of the contrast", AT(shadow), 4},
    {"shadow_direction_deg", "°", "where those edges face, from x towards y",
     AT(shadow_direction_deg), 1},
    {"row_jumps", "", "places where rows jump", AT(row_jumps), 0},
    {"row_jump_px", "px", "largest jump of rows", AT(row_jump_px), 2},
    {"shading", "", "range of the background over the picture, share of the contrast", AT(shading),
     3},
    {"gamma", "", "exponent of the tone curve that the edges show", AT(gamma), 3},
    {"u_gamma", "", "its standard uncertainty", AT(u_gamma), 3},
    {"tone_s", "", "S-shaped part of the tone curve: slope at its middle less 1", AT(tone_s), 3},
    {"sharpen_amount", "", "amount of the unsharp mask that explains the overshoot",
     AT(sharpen_amount), 3},
    {"sharpen_radius_px", "px", "its radius", AT(sharpen_radius_px), 2},
    {"level", "", "level of an edge less half of the contrast, share of the contrast", AT(level),
     4},
    {"u_level", "", "its standard uncertainty", AT(u_level), 4},
    {NULL, NULL, NULL, 0, 0},
};

const fg_picture_words *fg_picture_finding_words(void) {
  return findings;
}

const fg_picture_member *fg_picture_members(void) {
  return members;
}
