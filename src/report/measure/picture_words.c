/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings of a picture in words, and the members of its state. */
#include "foilgauge/picture.h"

#define AT(member) offsetof(fg_picture_state, member)

/* Options as SANE's backends spell them, capabilities of TWAIN 2, properties of WIA 2: their
 * values, or in brackets the devices that have them. */
static const fg_picture_words findings[] = {
    {FG_PICTURE_FEW_LEVELS, "few_levels",
     "There are so few gray levels that the place of an edge depends on where they lie.",
     "Scan in gray with 16 bits, or with 8: never in black and white.", "--mode Gray --depth 16",
     "ICAP_PIXELTYPE = TWPT_GRAY, ICAP_BITDEPTH = 16 or 8",
     "WIA_IPA_DATATYPE = WIA_DATA_GRAYSCALE, WIA_IPA_DEPTH = 16 or 8"},
    {FG_PICTURE_LEVEL_GAPS, "level_gaps",
     "Gray levels are missing between others: the driver stretched or bent the scale after "
     "rounding.",
     "Turn off automatic levels, brightness, contrast and gamma; scan with 16 bits.",
     "--brightness 0, --contrast 0, --shadow 0, --highlight 100, --depth 16",
     "ICAP_AUTOBRIGHT = FALSE, ICAP_BRIGHTNESS = 0, ICAP_CONTRAST = 0, ICAP_GAMMA = 1, "
     "ICAP_BITDEPTH = 16",
     "WIA_IPS_BRIGHTNESS = 0, WIA_IPS_CONTRAST = 0"},
    {FG_PICTURE_CLIPPED, "clipped_levels",
     "An end of the gray scale cuts the edges' profile: how bright or dark it would have been is "
     "not known.",
     "Turn off automatic levels and contrast; scan with less exposure.",
     "--brightness 0, --contrast 0, --shadow 0, --highlight 100, --white-level and --exposure "
     "lower",
     "ICAP_AUTOBRIGHT = FALSE, ICAP_BRIGHTNESS = 0, ICAP_CONTRAST = 0, ICAP_SHADOW = 0, "
     "ICAP_HIGHLIGHT = 255, ICAP_EXPOSURETIME shorter",
     "WIA_IPS_BRIGHTNESS = 0, WIA_IPS_CONTRAST = 0"},
    {FG_PICTURE_SHARPENED, "sharpened",
     "The picture is sharpened: edges overshoot, and a strip reads too thin or too thick.",
     "Turn off sharpening (unsharp mask, outline emphasis).",
     "--sharpness 0 (epson2, epkowa), --sharpen 0 (escl)",
     "ICAP_IMAGEFILTER = TWIF_NONE; an unsharp mask has no capability: the driver's own window has "
     "it",
     ""},
    {FG_PICTURE_TONE_CURVE, "tone_curve",
     "A tone curve moves the level at which edges lie: both edges of a strip move apart or "
     "together.",
     "Turn off automatic contrast and colour correction; scan with gamma 1.",
     "--gamma-correction 'User defined (Gamma=1.0)' (epson2, epkowa), --gamma 1 (pixma), "
     "--gamma-value 1 (gt68xx), --custom-gamma=yes --gamma-table '[0]0-[255]255' (genesys, "
     "plustek, snapscan; the last index is the scanner's), --analog-gamma 1 (airscan), "
     "--brightness 0, --contrast 0, --color-correction None",
     "ICAP_GAMMA = 1 (2.2 unless it is set), ICAP_AUTOBRIGHT = FALSE, ICAP_BRIGHTNESS = 0, "
     "ICAP_CONTRAST = 0, ICAP_COLORMANAGEMENTENABLED = FALSE",
     "WIA_IPS_BRIGHTNESS = 0, WIA_IPS_CONTRAST = 0; gamma has no property"},
    {FG_PICTURE_BLOCK_NOISE, "block_noise",
     "Blocks of 8 × 8 pixels show: the picture once was a JPEG, which moves edges.",
     "Have the driver send it without loss, to PNG or TIFF.",
     "--format png, --compression None (hpaio; where it has JPEG alone, --jpeg-quality 0), "
     "--jpeg=no (xerox_mfp)",
     "ICAP_COMPRESSION = TWCP_NONE, ICAP_XFERMECH = TWSX_NATIVE or TWSX_MEMORY",
     "WIA_IPA_COMPRESSION = WIA_COMPRESSION_NONE, WIA_IPA_FORMAT = WiaImgFmt_BMP, WiaImgFmt_PNG or "
     "WiaImgFmt_TIFF"},
    {FG_PICTURE_UNEVEN_BLUR, "uneven_blur",
     "The picture is blurred more along one direction than across it.",
     "Scan with equal resolutions that the optics have along both axes; clean the glass.",
     "--resolution of the optics",
     "ICAP_XRESOLUTION = ICAP_YRESOLUTION, neither above ICAP_XNATIVERESOLUTION or "
     "ICAP_YNATIVERESOLUTION",
     "WIA_IPS_XRES = WIA_IPS_YRES, neither above WIA_IPS_OPTICAL_XRES or WIA_IPS_OPTICAL_YRES"},
    {FG_PICTURE_CORRELATED_NOISE, "correlated_noise",
     "The noise of neighbouring pixels is alike: they were interpolated, turned or smoothed.",
     "Scan with the resolution of the optics; turn off noise reduction, despeckling and deskewing.",
     "--resolution of the optics, --preview=no, --quality-scan=yes (avision), --high-quality=yes "
     "(snapscan), --swdeskew=no and --swdespeck 0 (document scanners)",
     "ICAP_XRESOLUTION = ICAP_XNATIVERESOLUTION, ICAP_YRESOLUTION = ICAP_YNATIVERESOLUTION, "
     "ICAP_XSCALING = ICAP_YSCALING = 1, ICAP_NOISEFILTER = TWNF_NONE, ICAP_IMAGEFILTER = "
     "TWIF_NONE, ICAP_AUTOMATICDESKEW = FALSE, ICAP_ROTATION = 0",
     "WIA_IPS_XRES = WIA_IPS_OPTICAL_XRES, WIA_IPS_YRES = WIA_IPS_OPTICAL_YRES, "
     "WIA_IPS_AUTO_DESKEW = WIA_AUTO_DESKEW_OFF"},
    {FG_PICTURE_SHADOW, "shadow",
     "A shadow or the foil's wall shows beside edges of some directions, and moves "
     "them. The uncertainties of radii and angles hold that.",
     "Lay the foil flat on the glass and close the lid; turn the foil and scan it again.", "", "",
     ""},
    {FG_PICTURE_ROW_JUMPS, "row_jumps",
     "Rows are missing, doubled or shifted: the carriage stopped, or the picture was stitched.",
     "Scan without a pause: a smaller window, a lower resolution, a faster connection.",
     "-l, -t, -x, -y (a smaller window)", "ICAP_FRAMES (a smaller window)",
     "WIA_IPS_XPOS, WIA_IPS_YPOS, WIA_IPS_XEXTENT, WIA_IPS_YEXTENT (a smaller window)"},
    {FG_PICTURE_CHANNEL_SCALE, "channel_scale",
     "The colour channels differ in magnification, and nothing says which is right: lengths may be "
     "off by as much; their mean blurs edges, too.",
     "Scan in gray, or calibrate the channel that is measured by parts of known size.",
     "--mode Gray, --color-filter Green (genesys)", "ICAP_PIXELTYPE = TWPT_GRAY",
     "WIA_IPA_DATATYPE = WIA_DATA_GRAYSCALE"},
    {FG_PICTURE_SHADING, "shading", "The light changes much over the picture.",
     "Let the lamp warm up and the scanner calibrate itself; close the lid and keep other light "
     "out.",
     "--calibrate Always (pixma), --clear-calibration (genesys), --quality-cal=yes (avision, "
     "snapscan, umax)",
     "ICAP_LAMPSTATE = TRUE, ICAP_LIGHTPATH = TWLP_REFLECTIVE",
     "WIA_IPS_LAMP = WIA_LAMP_ON, WIA_IPS_WARM_UP_TIME"},
    {FG_PICTURE_UNKNOWN_PROFILE, "edge_profile",
     "The edges' profile is none that a scanner makes of light: widths may be off by more than is "
     "known.",
     "Turn off everything in the driver that improves pictures; foilgauge-scanning(7) lists it.",
     "every option that samples/station/scan.sh --show writes",
     "ICAP_IMAGEFILTER = TWIF_NONE, ICAP_NOISEFILTER = TWNF_NONE, ICAP_GAMMA = 1, ICAP_AUTOBRIGHT "
     "= FALSE",
     "WIA_IPS_CUR_INTENT = WIA_INTENT_NONE, WIA_IPS_BRIGHTNESS = 0, WIA_IPS_CONTRAST = 0"},
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

/* Distortions that no model describes would be applied to every scan. Rows that jump are allowed: a
 * step of the carriage is an effect that the loop finds. So is a profile that no tone curve
 * explains: it is the same for all edges, and known diameters determine its level. The blocks of a
 * JPEG move edges at random, which their scatter tells, and all of them by as much, which is in
 * their level. */
const fg_picture_words *fg_picture_spoils_model(unsigned found) {
  const unsigned spoiling = FG_PICTURE_CLIPPED | FG_PICTURE_FEW_LEVELS | FG_PICTURE_SHADOW;
  for (const fg_picture_words *words = findings; words->name; words++)
    if (words->finding & found & spoiling) return words;
  return NULL;
}

const fg_picture_member *fg_picture_members(void) {
  return members;
}
