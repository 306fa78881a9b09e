/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a design. Those of one kind of foil are written where the design is of that kind. */
#include "report/design/members.h"

#include <math.h>

#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "report/design/kind_members.h"

#define LENGTH_SCHEMA "{\"type\": \"number\", \"exclusiveMinimum\": 0}"
#define ANGLE_SCHEMA  "{\"type\": \"number\", \"exclusiveMinimum\": 0, \"exclusiveMaximum\": 360}"
/* 0 is not stated. */
#define STATED .options = FG_MEMBER_NOT_NEGATIVE | FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL
enum { COUNT_MAX = 100000 };

static fg_design_group group_of(const fg_subject *subject) {
  const fg_design *design = subject->object;
  return fg_foil_traits_of(design->kind)->group;
}

bool fg_design_is_of_bumps(const fg_subject *subject) {
  return group_of(subject) == FG_DESIGN_BUMPS;
}

bool fg_design_is_of_beams(const fg_subject *subject) {
  return group_of(subject) == FG_DESIGN_BEAMS;
}

bool fg_design_is_of_discs(const fg_subject *subject) {
  return group_of(subject) == FG_DESIGN_DISCS;
}

bool fg_design_is_of_arc(const fg_subject *subject) {
  return group_of(subject) == FG_DESIGN_ARC;
}

bool fg_design_is_of_grid(const fg_subject *subject) {
  return group_of(subject) == FG_DESIGN_GRID;
}

static bool is_bent(const fg_subject *subject) {
  return fg_design_is_of_bumps(subject) || fg_design_is_of_arc(subject);
}

static bool is_of_sheet(const fg_subject *subject) {
  return !fg_design_is_of_discs(subject) && !fg_design_is_of_grid(subject);
}

static const char *kind_choice(size_t i) {
  return i < FG_FOIL_KINDS ? fg_foil_kind_word((fg_foil_kind)i) : NULL;
}

static const char *datum_choice(size_t i) {
  return i <= FG_DATUM_OUTER ? fg_datum_word((fg_datum)i) : NULL;
}

static const char *mark_choice(size_t i) {
  return i < FG_MARK_KINDS ? fg_mark_kind_word((fg_mark_kind)i) : NULL;
}

static const char *gauge_choice(size_t i) {
  return i <= FG_GAUGE_HOLE ? fg_gauge_word((fg_gauge_kind)i) : NULL;
}

static const char *const tone_words[] = {"unknown", "linear", NULL};

static bool is_tone_stated(const fg_subject *subject) {
  return ((const fg_design *)subject->object)->tone != FG_TONE_UNKNOWN;
}

static bool is_thickness_measured(const fg_subject *subject) {
  return ((const fg_design *)subject->object)->thickness_measured_mm > 0;
}

static bool is_calibration_stated(const fg_subject *subject) {
  const fg_calibration *c = &((const fg_design *)subject->object)->calibration;
  return c->stated || c->not_needed[0];
}

static void write_calibration(fg_json *json, const char *name, const fg_subject *subject) {
  fg_calibration_write(json, name, &((const fg_design *)subject->object)->calibration);
}

static bool has_artefact(const fg_subject *subject) {
  return ((const fg_design *)subject->object)->artefact.name[0];
}

#define UNLESS_EMPTY .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL
static const fg_member artefact_rows[] = {
    {FG_TEXT("name", fg_artefact, name), .options = FG_MEMBER_REQUIRED,
     .words = "How it is marked."},
    {FG_TEXT("certificate", fg_artefact, certificate), UNLESS_EMPTY, .words = "Its number."},
    {FG_TEXT("date", fg_artefact, date), UNLESS_EMPTY, .pattern = "^[0-9.-]{10}$",
     .words = "Of the certificate, as 2026-03-14."},
    {FG_TEXT("due", fg_artefact, due), UNLESS_EMPTY, .pattern = "^[0-9.-]{10}$",
     .words = "The last day that it holds: a model of the artefact refuses younger scans."},
};
#undef UNLESS_EMPTY
const fg_members fg_artefact_members = FG_MEMBERS_OF_FILE(artefact_rows, "artefact", "design");

static fg_status read_artefact(const fg_reading *reading, const fg_member *member,
                               const cJSON *item, void *object) {
  const fg_reading inside = fg_reading_inside(reading, member->name);
  fg_artefact artefact = {{0}, {0}, {0}, {0}};
  fg_context words = {0};
  FG_TRY(fg_object_read(&inside, &fg_artefact_members, item, &artefact));
  fg_status status = fg_artefact_check(&words, "artefact", &artefact);
  if (status != FG_OK)
    return fg_fail(reading->ctx, status, "%s%s%.900s", reading->path ? reading->path : "",
                   reading->path ? ": " : "", words.message);
  *(fg_artefact *)(void *)((char *)object + member->offset) = artefact;
  return FG_OK;
}

static const fg_member thickness_rows[] = {
    {FG_NUMBER("value_mm", fg_design, thickness_measured_mm),
     .options = FG_MEMBER_REQUIRED | FG_MEMBER_ABOVE_0, .words = "Its thickness."},
    {FG_NUMBER("u_mm", fg_design, u_thickness_measured_mm),
     .options = FG_MEMBER_REQUIRED | FG_MEMBER_ABOVE_0, .words = "Its standard uncertainty."},
};
static const fg_members thickness_members = FG_MEMBERS(thickness_rows);

static const fg_member tolerance_rows[] = {
    {FG_NUMBER("min", fg_tolerance, lower), .options = FG_MEMBER_LEFT_OUT,
     .words = "Lower limit, in the quantity's unit."},
    {FG_NUMBER("max", fg_tolerance, upper), .options = FG_MEMBER_LEFT_OUT, .words = "Upper limit."},
};
static const fg_members tolerance_members = FG_MEMBERS(tolerance_rows);
static const fg_tolerance no_limits = {.lower = -INFINITY, .upper = INFINITY};

static const fg_member gauge_rows[] = {
    {FG_WORD("kind", fg_gauge, kind, NULL), .choice_at = gauge_choice,
     .options = FG_MEMBER_REQUIRED,
     .words = "\"leaf\" (of a feeler gauge, standing on its edge), \"pin\" (seen end-on), \"ring\" "
              "(of known bore) or \"hole\"."},
    {FG_NUMBER("width_mm", fg_gauge, width_mm), .options = FG_MEMBER_REQUIRED,
     .schema = "{\"type\": \"number\", \"minimum\": 0.005, \"maximum\": 200}",
     .words = "Its known width, from 0.005 to 200."},
    {FG_NUMBER("u_mm", fg_gauge, u_mm), .options = FG_MEMBER_REQUIRED, .schema = LENGTH_SCHEMA,
     .words = "Standard uncertainty of that, at most a tenth of the width."},
};
const fg_members fg_gauge_members = FG_MEMBERS(gauge_rows);

static const fg_member design_rows[] = {
    {FG_HEAD("foilgauge/design/1"), .options = FG_MEMBER_NO_VERSION},
    {FG_TEXT("name", fg_design, name), .words = "Of the design, as reports show it."},
    {FG_WORD("form", fg_design, kind, NULL), .choice_at = kind_choice,
     .words =
         "\"classical\" (bumps, lands, a lip at one end), \"sinusoidal\" (long fillets, short "
         "lands, no lip), \"arc\" (a plain strip, as a top foil), \"cantilever\" (a flat foil with "
         "beams cut out of it), \"discs\" (no foil: round gauges) or \"grid\" (no foil: a plate or "
         "board with marks on a square lattice)."},
    {FG_WORD("datum", fg_design, datum, NULL), .choice_at = datum_choice, .present = is_bent,
     .words = "Which line of the strip the lengths belong to: \"mid\", \"inner\" (the shaft's "
              "side) or \"outer\" (the sleeve's)."},
    {FG_COUNT("bump_count", fg_design, bumps.count), .lowest = 0, .highest = COUNT_MAX,
     .present = fg_design_is_of_bumps, .words = "Bumps of a foil; 0: not stated."},
    {FG_NUMBER("bump_radius_mm", fg_design, bumps.radius_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_bumps, .words = "R, of the circle of a bump."},
    {FG_NUMBER("bump_angle_deg", fg_design, bumps.angle_deg), .schema = ANGLE_SCHEMA,
     .present = fg_design_is_of_bumps,
     .words = "alpha, at the bump's centre between the crossings with the overall circle."},
    {FG_NUMBER("overall_radius_mm", fg_design, overall_radius_mm), .schema = LENGTH_SCHEMA,
     .present = is_bent, .words = "R0, of the circle through the lands, or of an arc."},
    {FG_NUMBER("sleeve_radius_mm", fg_design, bumps.sleeve_radius_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_bumps,
     .words = "Of the bore that the foil is pressed into; without it, `overall_radius_mm`."},
    {FG_NUMBER("pitch_deg", fg_design, bumps.pitch_deg), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_bumps, .words = "From bump to bump about the overall centre."},
    {FG_NUMBER("fillet_radius_mm", fg_design, bumps.fillet_radius_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_bumps, .words = "Between a bump and its lands."},
    {FG_NUMBER("subtended_angle_deg", fg_design, arc.subtended_angle_deg), .schema = ANGLE_SCHEMA,
     .present = fg_design_is_of_arc,
     .words = "Of form \"arc\" alone: from end to end, about the centre."},
    {FG_COUNT("beam_count", fg_design, beams.count), .lowest = 0, .highest = COUNT_MAX,
     .present = fg_design_is_of_beams,
     .words = "Of form \"cantilever\" alone, as all up to `clearance_mm` but the thickness: beams "
              "of a foil; 0: not stated."},
    {FG_NUMBER("beam_length_mm", fg_design, beams.length_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_beams, .words = "L, from the root of a beam to its free end."},
    {FG_NUMBER("beam_width_mm", fg_design, beams.width_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_beams, .words = "w, of a beam."},
    {FG_NUMBER("thickness_mm", fg_design, thickness_mm), .schema = LENGTH_SCHEMA,
     .present = is_of_sheet, .words = "Of the strip, or of a cantilever's sheet."},
    {FG_NUMBER("u_thickness_mm", fg_design, beams.u_thickness_mm), STATED,
     .present = fg_design_is_of_beams,
     .words = "Standard uncertainty of `thickness_mm`, which goes into that of the compliance; a "
              "scan does not see the thickness of what lies flat."},
    {FG_NUMBER("sagitta_mm", fg_design, beams.sagitta_mm), STATED, .present = fg_design_is_of_beams,
     .words = "s, by which a beam stands off its sheet once it is bent."},
    {FG_NUMBER("elastic_modulus_gpa", fg_design, beams.elastic_modulus_gpa), STATED,
     .present = fg_design_is_of_beams,
     .words = "E of the sheet; without it the compliance is told against the design's alone."},
    {FG_NUMBER("clearance_mm", fg_design, beams.clearance_mm), STATED,
     .present = fg_design_is_of_beams,
     .words = "Of the bearing with beams of this sagitta; its change is then told in percent, "
              "too."},
    {FG_NUMBER("top_foil_thickness_mm", fg_design, bumps.top_foil_thickness_mm), STATED,
     .present = fg_design_is_of_bumps,
     .words = "Of the plain foil between bumps and rotor, 0 for none: it is taken off every "
              "clearance, that of the design too; one that leaves no clearance is refused."},
    {FG_NUMBER("rotor_diameter_mm", fg_design, bumps.rotor_diameter_mm), .schema = LENGTH_SCHEMA,
     .present = fg_design_is_of_bumps, .words = "Of the rotor in the bearing."},
    {FG_NUMBERS_OF("diameters_mm", fg_design, discs.diameters_mm, discs.count),
     .highest = FG_DIAMETERS_MAX, .present = fg_design_is_of_discs,
     .schema = "{\"type\": \"array\", \"maxItems\": 256, \"items\": " LENGTH_SCHEMA "}",
     .words = "Of form \"discs\" alone: known diameters of the gauges, in any order."},
    {FG_NUMBER("u_diameters_mm", fg_design, discs.u_diameters_mm),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL, .present = fg_design_is_of_discs,
     .schema = "{\"type\": \"number\", \"minimum\": 0, \"maximum\": 0.1}",
     .words = "Standard uncertainty of each of these diameters; without it 0.0005 where the level "
              "of edges is told from them."},
    {FG_WORD("marks", fg_design, grid.marks, NULL), .choice_at = mark_choice,
     .present = fg_design_is_of_grid,
     .words = "Of form \"grid\" alone, as the next four: \"dots\", \"chessboard\" (its corners), "
              "\"crosses\" or \"lines\" (the graduation of a ruler, one axis)."},
    {FG_NUMBER("pitch_mm", fg_design, grid.pitch_mm), STATED, .present = fg_design_is_of_grid,
     .words = "From mark to mark; without it the scale stays unknown."},
    {FG_NUMBER("u_pitch_mm", fg_design, grid.u_pitch_mm), STATED, .present = fg_design_is_of_grid,
     .words = "Standard uncertainty of the pitch along each axis. Without it the board may have a "
              "wrong scale, other along its two axes, as a printed one has."},
    {FG_NUMBER("u_place_mm", fg_design, grid.u_place_mm), STATED, .present = fg_design_is_of_grid,
     .words = "Standard uncertainty of the place of a mark on the lattice."},
    {FG_TEXT("certificate", fg_design, grid.certificate),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL, .present = fg_design_is_of_grid,
     .words = "Path of a CSV with the calibrated place of each mark: `column`, `row`, `x_mm`, "
              "`y_mm` and its standard uncertainty `u_um`, x along the columns and y down along "
              "the rows as a scan shows them (lines: `column`, `x_mm`, `u_um`). A relative path "
              "begins at the design's folder. The loop takes the places in place of a lattice's."},
    {FG_WORD("tone", fg_design, tone, tone_words), .present = is_tone_stated,
     .words = "\"linear\" says that the scanner's counts are proportional to the light, and you "
              "vouch for it: thickness, diameters and clearances then hold no unknown tone curve. "
              "Without it, \"unknown\"."},
    {FG_GROUP("thickness_measured", &thickness_members), .present = is_thickness_measured,
     .words = "Of the strip by a micrometer, at 20 °C: an object with `value_mm` and its standard "
              "uncertainty `u_mm`. It is the thickness in force, of clearances and stiffness, and "
              "the scan's is held against it."},
    {FG_MAP("tolerances", fg_design, tolerances, tolerance_count, quantity, &tolerance_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NOT_EMPTY, .fresh = &no_limits,
     .highest = FG_TOLERANCES_MAX,
     .words = "An object of quantities with \"min\", \"max\" or both; below."},
    {FG_OBJECT("calibration", fg_design, calibration, &fg_calibration_members),
     .read = fg_calibration_read, .write = write_calibration, .present = is_calibration_stated,
     .schema = "{\"anyOf\": [{\"$ref\": \"#/$defs/calibration\"}, " FG_CALIBRATION_WORDS
               ", {\"type\": \"null\"}]}",
     .words = "What the statistics of a scan cannot know: how long a pixel is, how warm the part "
              "was; below. \"flatbed\" is the default for an unknown flatbed; \"not needed: "
              "REASON\" lets values be judged without any."},
    {FG_OBJECT("artefact", fg_design, artefact, &fg_artefact_members), .read = read_artefact,
     .present = has_artefact,
     .words = "What the known sizes of gauges are traced to: a plate's `name`, its `certificate`, "
              "`date` and `due`. The scanner's model that `foilgauge loop` makes of it keeps them, "
              "and reports then say \"plate\"."},
    {FG_ARRAY("gauges", fg_design, gauges, gauge_count, &fg_gauge_members),
     .options = FG_MEMBER_LEFT_OUT, .highest = FG_GAUGES_MAX,
     .words = "An array of gauges that lie on the glass in the same scan, as {\"kind\": \"leaf\", "
              "\"width_mm\": 0.1, \"u_mm\": 0.0005}, which tell at which level edges lie."},
};
const fg_members fg_design_members = FG_MEMBERS(design_rows);

static const void *find_usual_design(void) {
  static fg_design usual;
  fg_design_default(&usual);
  return &usual;
}

static const fg_members *const descriptions[] = {&fg_calibration_members,
                                                 &fg_calibration_used_members, NULL};

const fg_document fg_design_document = {
    .file = "design",
    .title = "foilgauge design",
    .description = "What a part should be, and the tolerances it is judged by. Members that are "
                   "absent keep the value of the built-in Gen II design.",
    .made_by = "a design file",
    .members = &fg_design_members,
    .is_read = true,
    .find_usual = find_usual_design,
    .describes = descriptions,
};
