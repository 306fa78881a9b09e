/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and sentences of the flags of foils, bumps and beams (words.h says which form each has).
 * The findings of a picture have theirs in report/measure/picture_words.c. */
#include "foilgauge/words.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/foil_kind.h"

static const fg_flag_words foil_flags[] = {
    {FG_FOIL_TOUCHES_BORDER, "touches_border",
     "The border of the scan cuts the foil: move it further inside and scan again."},
    {FG_FOIL_TOUCHES_OTHER, "touches_other",
     "Something else touches the foil: what lies at that place may be wrong."},
    {FG_FOIL_NO_LIP, "no_lip", "No lip was found: the bumps are numbered clockwise as seen."},
    {FG_FOIL_BUMP_COUNT, "bump_count", "The number of bumps is not the one the design states."},
    {FG_FOIL_MISSING_BUMP, "missing_bump",
     "A place where a bump belongs is empty, or its bump is crushed to a third of its height or "
     "less."},
    {FG_FOIL_FEW_LANDS, "few_lands",
     "The overall circle rests on few lands: what follows from it is less certain."},
    {FG_FOIL_LAND_DEVIATES, "land_deviates",
     "At one place a land leaves its circle, a fillet is not as the others, an arc is broken, or "
     "all lands beyond it are displaced, by more than the scatter of the edges explains: a dent, a "
     "crease, or rows of the scan that jump. The overall radius is that of the lands without such "
     "places, as far as they stand out; heights of bumps, and after a dent the overall radius, may "
     "be off by more than their U: look at the foil, and scan again."},
    {FG_FOIL_CLIPPED, "clipped",
     "Pixels at the edges are at the end of the gray scale: scan with less exposure or contrast."},
    {FG_FOIL_SIDE_BAND, "side_band",
     "The wall of the foil shows beside one edge: that edge may be shifted."},
    {FG_FOIL_GAP, "gap", "The strip is interrupted, or its edge is hidden, somewhere."},
    {FG_FOIL_ROUGH_EDGE, "rough_edge",
     "The residuals are correlated along the strip; the uncertainties take that into account."},
    {FG_FOIL_COARSE_RESOLUTION, "coarse_resolution",
     "The strip is so few pixels wide that its edges blur into each other: values may be off by "
     "more than their uncertainty. Scan at a higher resolution."},
    {FG_FOIL_RESOLUTION_CONTRADICTS_FILE, "resolution_contradicts_file",
     "The resolution that was given is not the one that the file states: if the file is right, "
     "every length is wrong by their ratio."},
    {FG_FOIL_BUMPS_ON_ARC, "bumps_on_arc",
     "There is a bump or a dent on what should be a plain strip; the circle is that of the rest."},
    {FG_FOIL_LIP, "lip",
     "An end is bent away, as a lip is: the circle is that of the rest, and no angle is told."},
    {FG_FOIL_NO_END, "end_not_found",
     "An end of the strip is hidden, torn or no straight cut: no angle is told."},
    {FG_FOIL_UNEQUAL_RESOLUTION, "unequal_resolution",
     "The resolutions along x and y differ: radii and heights may be off by more than their "
     "uncertainty, and a sound bump may be missed. Scan with equal ones."},
    {FG_FOIL_BEAM_COUNT, "beam_count", "The number of beams is not the one the design states."},
    {FG_FOIL_MISSING_BEAM, "missing_beam", "A place where a beam belongs is empty."},
    {FG_FOIL_BEAM_PLACES_UNKNOWN, "beam_places_unknown",
     "Beams are missing, and which of them cannot be told: they are numbered in their order, and "
     "are in no statistics by number."},
    {FG_FOIL_THICKNESS_CONTRADICTS, "thickness_contradicts",
     "The scan's thickness and the one stated as measured differ by more than their uncertainty: "
     "either the statement is not of this strip, or the scan's settings, its resolution or "
     "something beside the edges make the scan wrong. Measure the strip again; scan without "
     "sharpening and with a linear tone."},
    {FG_FOIL_OTHER_THICKNESS, "other_thickness",
     "The strip is far from the design's thickness: it is another material, its edges are not what "
     "they seem, or the resolution is wrong. Measure it by a micrometer and state "
     "thickness_measured."},
    {FG_FOIL_LOSSY, "lossy",
     "The scan was compressed with loss (JPEG), which moves edges: the uncertainties are wider by "
     "what that does. Scan to PNG or TIFF."},
    {FG_FOIL_NOT_MEASURED, "not_measured", "The foil could not be measured."},
    {FG_FOIL_NOT_THIS_DESIGN, "not_this_design",
     "As seen, it is no foil of this design: its values stand, and are not judged."},
    {FG_FOIL_BEYOND_MODEL_REGION, "beyond_model_region",
     "It reaches beyond the region that the scanner's model was found in: there the correction is "
     "not known to hold."},
    {FG_FOIL_OVERALL_RADIUS_LEFT, "overall_radius_not_corrected",
     "The overall radius is left as measured: what would correct it is not known well enough to "
     "make it better."},
    {FG_FOIL_RADIUS_LEFT, "radius_not_corrected",
     "The bump radii are left as measured: what would correct them is not known well enough to "
     "make them better."},
    {FG_FOIL_HEIGHT_LEFT, "height_not_corrected",
     "The bump heights are left as measured: what would correct them is not known well enough to "
     "make them better."},
    {0, NULL, NULL},
};

static const fg_flag_words bump_flags[] = {
    {FG_BUMP_CRUSHED, "crushed", "far lower, wider or rounder than a sound bump"},
    {FG_BUMP_NOT_FITTED, "not_fitted", "no circle could be fitted"},
    {FG_BUMP_NO_CROSSING, "no_crossing", "its circle does not meet the overall circle: no angle"},
    {FG_BUMP_POOR_FIT, "poor_fit", "it is not a circle within the noise of the edges"},
    {FG_BUMP_OUTLIERS, "outliers", "burr or dust was given less weight"},
    {FG_BUMP_DISTURBED_EDGE, "disturbed_edge", "dust or a burr hides part of its arc"},
    {FG_BUMP_GAP, "gap", "the strip is cut within its arc"},
    {FG_BUMP_TOUCHES_OTHER, "touches_other", "another part touches its arc or the land beside it"},
    {FG_BUMP_LOSSY, "lossy", "the scan was compressed with loss (JPEG): u is wider for it"},
    {FG_BUMP_OUT_OF_TOLERANCE, "out_of_tolerance", "a tolerance is exceeded"},
    {FG_BUMP_BEYOND_MODEL_REGION, "beyond_model_region",
     "it lies beyond the region that the scanner's model was found in"},
    {0, NULL, NULL},
};

static const fg_flag_words beam_flags[] = {
    {FG_BEAM_NOT_FITTED, "not_fitted", "a long edge is not to be seen"},
    {FG_BEAM_TORN_TIP, "torn_tip", "its end is no straight edge: no length"},
    {FG_BEAM_NO_FLOOR, "no_floor", "no edge is seen where its root should be: no length"},
    {FG_BEAM_ONE_FLOOR, "one_floor", "the cut beside it has a floor on one side only"},
    {FG_BEAM_BENT, "bent", "it bows or leans to one side in the plane of the foil"},
    {FG_BEAM_OUTLIERS, "outliers", "burr or dust on its edges was left out"},
    {FG_BEAM_DISTURBED_EDGE, "disturbed_edge", "dust or a burr hides part of an edge"},
    {FG_BEAM_TOUCHES_BORDER, "touches_border", "the border of the scan cuts what it belongs to"},
    {FG_BEAM_NARROW_CUT, "narrow_cut",
     "the cut beside it is so few pixels wide that its edges blur into each other: scan at a "
     "higher "
     "resolution"},
    {FG_BEAM_OUT_OF_TOLERANCE, "out_of_tolerance", "a tolerance is exceeded"},
    {0, NULL, NULL},
};

const fg_flag_words *fg_beam_flag_words(void) {
  return beam_flags;
}

const fg_flag_words *fg_foil_flag_words(void) {
  return foil_flags;
}

unsigned fg_foil_flags_told(const fg_design *design, const fg_foil *foil) {
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  bool without_lip = kind->has_bumps && !kind->has_lip;
  return without_lip ? foil->flags & ~(unsigned)FG_FOIL_NO_LIP : foil->flags;
}

const fg_flag_words *fg_bump_flag_words(void) {
  return bump_flags;
}

const char *fg_channel_word(fg_channel channel) {
  switch (channel) {
  case FG_CHANNEL_AUTO:
    return "auto";
  case FG_CHANNEL_RED:
    return "red";
  case FG_CHANNEL_GREEN:
    return "green";
  case FG_CHANNEL_BLUE:
    return "blue";
  case FG_CHANNEL_LUMINANCE:
    return "luminance";
  }
  return "";
}

const char *fg_colour_state_word(fg_colour_state state) {
  switch (state) {
  case FG_COLOUR_MEASURED:
    return "measured";
  case FG_COLOUR_IDENTICAL:
    return "identical";
  case FG_COLOUR_NO_CONTRAST:
    return "no_contrast";
  case FG_COLOUR_FEW_EDGES:
    return "few_edges";
  }
  return "";
}

const char *fg_datum_word(fg_datum datum) {
  switch (datum) {
  case FG_DATUM_MID:
    return "mid";
  case FG_DATUM_INNER:
    return "inner";
  case FG_DATUM_OUTER:
    return "outer";
  }
  return "";
}

void fg_thickness_words(const fg_design *design, const fg_foil *foil, char *words, size_t size) {
  const fg_thickness strip = fg_foil_thickness(design, foil);
  double more_um = 1000 * (strip.mm - design->thickness_mm);
  words[0] = 0;
  if (!fg_thickness_differs(design, &strip)) return;
  fg_text_clip(words, size,
               "the design says %.6g mm: clearances are over the strip as measured, and would be "
               "%.3g µm %s with the design's thickness",
               design->thickness_mm, fabs(more_um), more_um > 0 ? "larger" : "smaller");
}

const char *fg_orientation_word(fg_orientation orientation) {
  return orientation == FG_CLOCKWISE ? "clockwise" : "counterclockwise";
}

const char *fg_arc_kind_word(fg_arc_kind kind) {
  switch (kind) {
  case FG_ARC_NONE:
    return "none";
  case FG_ARC_LIP:
    return "lip";
  case FG_ARC_LAND:
    return "land";
  case FG_ARC_FILLET:
    return "fillet";
  case FG_ARC_BUMP:
    return "bump";
  case FG_ARC_END:
    return "end";
  }
  return "";
}
