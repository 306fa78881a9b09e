/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about bearings. */
#include "report/lot/parts_members.h"
#include "report/quantity_members.h"
#include "report/verdict_members.h"

static double find_pitch(const fg_subject *subject) {
  return fg_bearing_pitch_deg(subject->object);
}

static const fg_member place_rows[] = {
    {FG_COUNT("pads", fg_bearing_layout, pads), .lowest = 1, .words = "foils in a bearing"},
    {FG_COUNT("bumps_per_pad", fg_bearing_layout, bumps_per_pad), .lowest = 1,
     .words = "of each foil, from first_bump on"},
    {FG_COUNT("first_bump", fg_bearing_layout, first_bump), .lowest = 1,
     .words = "bump 1 is next to the lip"},
    {FG_NUMBER_BY("bump_pitch_deg", find_pitch), .options = FG_MEMBER_NEVER_NULL,
     .words = "from bump to bump about the bearing's axis"},
};
static const fg_members place_members = FG_MEMBERS(place_rows);

static const fg_member layout_rows[] = {
    {FG_SAME(&place_members), .offset = offsetof(fg_lot_analysis, layout)},
    {FG_TEXT("note", fg_lot_analysis, layout_note), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "what of it contradicts the design"},
};
static const fg_members layout_members = FG_MEMBERS(layout_rows);

static const fg_member unplaced_rows[] = {
    {FG_COUNT("without", fg_lot_unplaced, without),
     .words = "the manifest names no bearing, or too few are left for another"},
    {FG_COUNT("displaced", fg_lot_unplaced, displaced), .words = "their pad is taken"},
    {FG_COUNT("bad_pads", fg_lot_unplaced, bad_pads),
     .words = "took the next free pad, theirs is no number from 1 to pads"},
};
static const fg_members unplaced_members = FG_MEMBERS(unplaced_rows);

/* Label of the foil on a pad, which the subject's index counts. */
static const char *find_label_on_pad(const fg_subject *subject, char *buffer) {
  (void)buffer;
  const fg_lot_analysis *analysis = subject->whole;
  const fg_lot_foil *foil = ((const fg_lot_bearing *)subject->object)->pad[subject->index];
  return foil ? fg_manifest_label(&analysis->lot->manifest, foil->item) : NULL;
}

static const fg_member pad_rows[] = {{FG_TEXT_BY(NULL, find_label_on_pad)}};
static const fg_members pad_members = FG_MEMBERS(pad_rows);

static bool find_pad(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < ((const fg_lot_analysis *)list->whole)->layout.pads;
}

static bool is_clearance_known(const fg_subject *subject) {
  return ((const fg_lot_bearing *)subject->object)->known;
}

static const double *list_angles(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_bearing *bearing = subject->object;
  (void)values;
  *count = bearing->places;
  return bearing->angle_deg;
}

static const double *list_clearances(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_bearing *bearing = subject->object;
  (void)values;
  *count = bearing->places;
  return bearing->clearance_mm;
}

static const double *list_clearance_u(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_bearing *bearing = subject->object;
  (void)values;
  *count = bearing->places;
  return bearing->u_clearance_mm;
}

static const fg_member bearing_rows[] = {
    {FG_STRING("name", fg_lot_bearing, name), .words = "by the manifest; null: assumed"},
    {FG_COUNT("number", fg_lot_bearing, number), .lowest = 1},
    {FG_LIST_BY("pads", find_pad, &pad_members), .options = FG_MEMBER_LIST_ON_LINE,
     .words = "labels of its foils; null: missing"},
    {FG_NUMBERS_BY("angle_deg", list_angles), .words = "of each place"},
    {FG_NUMBERS_BY("clearance_mm", list_clearances),
     .words = "foils fitted into the sleeve; null: no value, or a crushed bump's"},
    {FG_NUMBERS_BY("u_clearance_mm", list_clearance_u), .words = "standard uncertainty of each"},
    {FG_VERDICT(fg_lot_bearing, decision.outcome.verdict)},
    {FG_JUDGEMENTS(fg_lot_bearing, decision),
     .words = "by the tolerances of a bearing: circularity_mm, clearance_min_mm (min_mm here), "
              "clearance_centred_min_mm (centred_min_mm), clearance_mean_mm, clearance_max_mm"},
    {FG_SAME_BY(fg_bearing_quantity_at), .offset = offsetof(fg_lot_bearing, clearance),
     .present = is_clearance_known},
};
static const fg_members bearing_members = FG_MEMBERS_DEFINED(bearing_rows, "bearing");

static double is_bearing_assumed(const fg_subject *subject) {
  const fg_lot *lot = ((const fg_lot_analysis *)subject->object)->lot;
  return fg_manifest_column(&lot->manifest, lot->settings.bearing_column) == FG_NO_COLUMN;
}

static bool has_clearance(const fg_subject *subject) {
  return ((const fg_lot_analysis *)subject->object)->clearance_pct.count;
}

static bool has_clearance_fitted(const fg_subject *subject) {
  return ((const fg_lot_analysis *)subject->object)->clearance_fitted_pct.count;
}

static const fg_member part_rows[] = {
    {FG_GROUP("bearing_layout", &layout_members),
     .words = "where the bumps lie around a bearing: the recipe's, what it leaves open the "
              "design's"},
    {FG_FLAG_BY("bearings_assumed", is_bearing_assumed),
     .words = "foils in a row were taken together: the manifest assigns no bearing"},
    {FG_OBJECT("foils_in_no_bearing", fg_lot_analysis, unplaced, &unplaced_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_LIST("bearings", fg_lot_analysis, bearings, bearing_count, &bearing_members)},
    {FG_OBJECT("clearance_relative_to_design_pct", fg_lot_analysis, clearance_pct,
               &fg_lot_spread_members),
     .options = FG_MEMBER_ON_LINE, .present = has_clearance,
     .words = "every bump, foils free as scanned"},
    {FG_OBJECT("clearance_fitted_relative_to_design_pct", fg_lot_analysis, clearance_fitted_pct,
               &fg_lot_spread_members),
     .options = FG_MEMBER_ON_LINE, .present = has_clearance_fitted,
     .words = "every bump, foils fitted into the sleeve"},
};
const fg_members fg_lot_bearing_members = FG_MEMBERS(part_rows);
