/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/load_test/members.h"

#include <math.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/load_report.h"
#include "report/verdict_members.h"

/* Value, u_ and u_repeat_ of an fg_load_value. */
#define LOAD_VALUE(name, object, field)                                                            \
  FG_NUMBER_U(name, object, field.value, field.u),                                                 \
      .repeat_offset = FG_FIELD(object, field.u_repeat, double)

static const fg_load_test *test_of(const fg_subject *subject) {
  return subject->whole;
}

/* Name of flag `i` of a table, "" where it is not among the flags, NULL behind the last. */
static const char *flag_at(const fg_load_flag *flags, unsigned set, size_t i) {
  return !flags[i].name || set & flags[i].flag ? flags[i].name : "";
}

/* Stiffness profile: a point. */
static const double *list_point(const fg_subject *subject, double *values, size_t *count) {
  const fg_load_point *p = subject->object;
  memcpy(values, (const double[]){p->x_mm, p->force_n, p->stiffness_n_mm, p->u_stiffness_n_mm},
         4 * sizeof *values);
  *count = 4;
  return values;
}

static const fg_member point_rows[] = {
    {FG_NUMBERS_BY(NULL, list_point), .lowest = 4, .highest = 4}};
static const fg_members point_members = FG_MEMBERS(point_rows);

#define PROFILE_WORDS "displacement in mm, force in N, dF/dx and its standard uncertainty in N/mm"

static const fg_member friction_rows[] = {
    {FG_NUMBER_U("intercept_n", fg_load_friction, a_n, u_a_n), .words = "without load"},
    {FG_NUMBER_U("slope", fg_load_friction, b, u_b), .words = "per newton of load"},
    {FG_NUMBER("way_mm", fg_load_friction, way_mm), .words = "travel over which it reverses"},
};
static const fg_members friction_members = FG_MEMBERS(friction_rows);

/* A direction. */
static const char *find_bearing_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  const fg_load_direction *d = subject->object;
  return test_of(subject)->bearings[d->bearing].name;
}

static const char *direction_flag_at(const fg_subject *subject, size_t i) {
  return flag_at(fg_load_flags(), ((const fg_load_direction *)subject->object)->flags, i);
}

static const char *direction_flag_choice(size_t i) {
  return fg_load_flags()[i].name;
}

static const char *find_flag_names(const fg_subject *subject, char *buffer) {
  const fg_load_direction *d = subject->object;
  fg_load_flag_words(d->flags, false, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

static const char *find_flag_words(const fg_subject *subject, char *buffer) {
  const fg_load_direction *d = subject->object;
  fg_load_flag_words(d->flags, true, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

/* Flags of the page's table: the stiffness at the end is told once of the bearing, above it. */
static const char *find_flag_words_of_page(const fg_subject *subject, char *buffer) {
  const fg_load_direction *d = subject->object;
  fg_load_flag_words(d->flags & ~(unsigned)FG_LOAD_AT_END, true, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

static int judge_direction(const fg_subject *subject) {
  return (int)fg_load_judge_direction(test_of(subject), subject->object);
}

static double find_step(const fg_subject *subject) {
  const fg_load_direction *d = subject->object;
  return d->step_mm > 0 ? d->step_mm : NAN;
}

static const char *look_at(const fg_subject *subject, fg_load_quantity quantity,
                           const fg_load_value *value) {
  return fg_verdict_word(fg_load_judge_value(test_of(subject), quantity, value));
}

static const char *look_at_clearance(const fg_subject *subject) {
  const fg_load_direction *d = subject->object;
  return look_at(subject, FG_LOAD_CLEARANCE, &d->clearance);
}

static const char *look_at_stiffness(const fg_subject *subject) {
  const fg_load_direction *d = subject->object;
  return look_at(subject, FG_LOAD_STIFFNESS, &d->stiffness);
}

static const char *look_at_loss(const fg_subject *subject) {
  const fg_load_direction *d = subject->object;
  return look_at(subject, FG_LOAD_LOSS, &d->loss);
}

/* Tables of directions are those of one bearing. */
static bool is_bearing_in_lot(const fg_subject *list) {
  const fg_load_bearing *bearing = list->object;
  return bearing->in_lot;
}

static bool is_bearing_judged(const fg_subject *list) {
  return test_of(list)->options.limit_count > 0;
}

static const fg_member direction_rows[] = {
    {FG_TEXT_BY("bearing", find_bearing_name), .options = FG_MEMBER_NEVER_NULL, .csv = {.rank = 1}},
    {FG_NUMBER("azimuth_deg", fg_load_direction, azimuth_deg), .words = "direction of the travel",
     .csv = {.rank = 1}, .page = {.rank = 1, .heading = "azimuth", .digits = 6, .unit = "°"},
     .terminal = {.rank = 1, .heading = "azimuth\n°", .decimals = 1}},
    {FG_TEXT("pad", fg_load_direction, pad), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "pad that the azimuth points at, as the file says", .csv = {.rank = 1}},
    {FG_TEXTS_BY("flags", direction_flag_at), .choice_at = direction_flag_choice,
     .options = FG_MEMBER_ON_LINE,
     .words = "what is wrong with the direction, or to be known of it"},
    {FG_WORD_BY("verdict", judge_direction, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_VERDICT_WORDS, .csv = {.rank = 1},
     .terminal = {.rank = 3, .heading = "verdict", .words = true}, .column = is_bearing_judged},
    {FG_TEXT_BY("flags", find_flag_names), .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1}},
    {FG_TEXT_BY("flags", find_flag_words), .options = FG_MEMBER_NOT_IN_JSON,
     .terminal = {.rank = 3, .heading = "to know", .words = true}},
    {FG_COUNT("samples", fg_load_direction, count), .words = "of the direction's record"},
    {FG_COUNT("strokes", fg_load_direction, strokes), .words = "from turn to turn"},
    {FG_COUNT("cycles", fg_load_direction, cycles), .words = "closed loops", .csv = {.rank = 1},
     .page = {.rank = 3, .heading = "cycles"}},
    {FG_NUMBER("travel_mm", fg_load_direction, travel_mm), .words = "from end to end"},
    {FG_RANGE("force_range_n", fg_load_direction, force_low_n, force_high_n),
     .words = "lowest and highest force"},
    {FG_NUMBER("force_zero_n", fg_load_direction, zero_n),
     .words = "reading of the load cell in the gap; the threshold counts from it"},
    {FG_NUMBER("force_noise_n", fg_load_direction, noise_n),
     .words = "standard deviation of a sample's force about the strokes' course"},
    {FG_NUMBER("displacement_noise_mm", fg_load_direction, noise_mm),
     .words = "that of its displacement, told apart by how the scatter follows the stiffness; with "
              "the step's uniform share"},
    {FG_NUMBER_BY("displacement_step_mm", find_step),
     .words = "the column is rounded to whole steps of it; null: no step is seen"},
    {LOAD_VALUE("clearance_mm", fg_load_direction, clearance), .look = look_at_clearance,
     .words = "travel between the contacts at the threshold, while loading",
     .heading = "clearance,\nµm", .csv = {.rank = 2},
     .page = {.rank = 1, .decimals = 1, .scale = 1000},
     .terminal = {.rank = 1, .decimals = 2, .scale = 1000}},
    {LOAD_VALUE("gap_mm", fg_load_direction, gap),
     .words = "free travel of the rotor: the clearance less what both foils yield under the "
              "threshold; null: not known, or none is shown",
     .heading = "gap,\nµm", .csv = {.rank = 5}, .page = {.rank = 1, .decimals = 1, .scale = 1000},
     .terminal = {.rank = 1, .decimals = 1, .scale = 1000}},
    {FG_NUMBER("push_mm", fg_load_direction, push_mm), .words = "contact when pushed"},
    {FG_NUMBER("pull_mm", fg_load_direction, pull_mm), .words = "contact when pulled"},
    {LOAD_VALUE("clearance_unloading_mm", fg_load_direction, unloading),
     .words = "the clearance while unloading", .heading = "unloading,\nµm", .csv = {.rank = 2},
     .page = {.rank = 1, .decimals = 1, .scale = 1000}},
    {FG_NUMBER("drift_um_per_cycle", fg_load_direction, drift_um_cycle),
     .words = "of the middle between the contacts"},
    {LOAD_VALUE("stiffness_n_mm", fg_load_direction, stiffness), .look = look_at_stiffness,
     .words = "largest stiffness up to just before the turn", .heading = "stiffness,\nN/mm",
     .csv = {.rank = 2}, .page = {.rank = 1, .decimals = 0},
     .terminal = {.rank = 1, .decimals = 1}},
    {FG_NUMBER("stiffness_at_mm", fg_load_direction, stiffness_at_mm), .words = "its place",
     .csv = {.rank = 2}},
    {LOAD_VALUE("stiffness_secant_n_mm", fg_load_direction, secant),
     .words = "between the loop's ends, each on its loading branch at the turn",
     .csv = {.rank = 3}},
    {LOAD_VALUE("loop_area_n_mm", fg_load_direction, area), .words = "energy lost in a cycle",
     .csv = {.rank = 2}},
    {LOAD_VALUE("loss_factor", fg_load_direction, loss), .look = look_at_loss,
     .words = "of the test: loop area / (pi K X^2), X half of the travel with the gap",
     .heading = "loss\nfactor", .csv = {.rank = 2}, .page = {.rank = 1, .decimals = 4},
     .terminal = {.rank = 1, .decimals = 4, .no_u = true}},
    {LOAD_VALUE("loss_factor_secant", fg_load_direction, loss_secant),
     .words = "the same with the secant's stiffness", .heading = "loss factor\n(secant)",
     .csv = {.rank = 2}, .page = {.rank = 1, .decimals = 4},
     .terminal = {.rank = 1, .decimals = 4, .no_u = true}},
    {LOAD_VALUE("loss_factor_foil", fg_load_direction, loss_foil),
     .words = "of the foils' compression alone: energy lost / (2 pi x elastic work)",
     .heading = "loss factor\n(foil)", .csv = {.rank = 3}, .page = {.rank = 1, .decimals = 4},
     .terminal = {.rank = 1, .decimals = 4, .no_u = true}},
    {FG_OBJECT("friction", fg_load_direction, friction, &friction_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_NEVER_NULL,
     .words = "half of what lies between the strokes, over the load"},
    {FG_NUMBER("friction_intercept_n", fg_load_direction, friction.a_n),
     .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 4}},
    {FG_NUMBER("friction_slope", fg_load_direction, friction.b), .options = FG_MEMBER_NOT_IN_JSON,
     .csv = {.rank = 4}},
    {LOAD_VALUE("predicted_clearance_mm", fg_load_direction, predicted),
     .words = "free travel that the lot's foils leave a rotor", .heading = "gap by\nthe lot, µm",
     .csv = {.rank = 4}, .page = {.rank = 2, .decimals = 1, .scale = 1000},
     .terminal = {.rank = 2, .decimals = 2, .scale = 1000, .no_u = true},
     .column = is_bearing_in_lot},
    {LOAD_VALUE("clearance_difference_mm", fg_load_direction, difference),
     .words = "gap_mm less predicted_clearance_mm: free travel against free travel, whatever the "
              "threshold",
     .heading = "difference\nof gaps, µm", .csv = {.rank = 4},
     .page = {.rank = 2, .decimals = 1, .scale = 1000},
     .terminal = {.rank = 2, .decimals = 2, .scale = 1000, .no_u = true},
     .column = is_bearing_in_lot},
    {FG_INTEGER("predicted_pad", fg_load_direction, predicted_pad),
     .words = "pad of the place that a rotor meets first, from 1; 0: not predicted"},
    {FG_ARRAY("course_push", fg_load_direction, profile[FG_LOAD_PUSH].point,
              profile[FG_LOAD_PUSH].count, &point_members),
     .words = PROFILE_WORDS},
    {FG_ARRAY("course_pull", fg_load_direction, profile[FG_LOAD_PULL].point,
              profile[FG_LOAD_PULL].count, &point_members),
     .words = PROFILE_WORDS},
    {FG_TEXT_BY("flags", find_flag_words_of_page), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 4, .heading = "to know", .words = true}},
};
const fg_members fg_load_direction_members = FG_MEMBERS(direction_rows);

fg_subject fg_load_bearing_subject(const fg_load_test *test, size_t bearing) {
  return (fg_subject){.object = &test->bearings[bearing], .whole = test, .index = bearing};
}

bool fg_load_direction_of_bearing(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_load_test *test = test_of(list);
  if (i >= test->direction_count) return false;
  element->object = test->directions[i].bearing == list->index ? &test->directions[i] : NULL;
  return true;
}

/* Orders of the clearance over the azimuths: the subject's index is the order. */
static bool find_harmonic(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_load_bearing *b = list->object;
  size_t order = 2 * i + 2;
  if (order > FG_LOAD_ORDER_MAX) return false;
  element->object = b->harmonic[order] ? b : NULL;
  element->index = order;
  return true;
}

static double find_order(const fg_subject *s) {
  return (double)s->index;
}

#define HARMONIC_VALUE(function, array)                                                            \
  static double function(const fg_subject *s) {                                                    \
    return ((const fg_load_bearing *)s->object)->array[s->index];                                  \
  }
HARMONIC_VALUE(find_amplitude, amplitude_mm)
HARMONIC_VALUE(find_u_amplitude, u_amplitude_mm)
HARMONIC_VALUE(find_cosine, cosine_mm)
HARMONIC_VALUE(find_sine, sine_mm)

static const fg_member harmonic_rows[] = {
    {FG_COUNT_BY("order", find_order), .words = "periods in a turn"},
    {FG_NUMBER_BY("amplitude_mm", find_amplitude), .u = find_u_amplitude},
    {FG_NUMBER_BY("cosine_mm", find_cosine)},
    {FG_NUMBER_BY("sine_mm", find_sine)},
};
static const fg_members harmonic_members = FG_MEMBERS(harmonic_rows);

static const char *break_away_flag_at(const fg_subject *subject, size_t i) {
  return flag_at(fg_break_away_flags(), ((const fg_break_away *)subject->object)->flags, i);
}

static const char *break_away_flag_choice(size_t i) {
  return fg_break_away_flags()[i].name;
}

static const fg_member break_away_rows[] = {
    {FG_COUNT("pulls", fg_break_away, pulls), .words = "readings of torque or force"},
    {FG_COUNT("dead_weights", fg_break_away, weights), .words = "different ones"},
    {FG_RANGE("dead_weight_range_n", fg_break_away, weight_low_n, weight_high_n),
     .words = "lightest and heaviest"},
    {FG_TEXTS_BY("flags", break_away_flag_at), .choice_at = break_away_flag_choice,
     .options = FG_MEMBER_ON_LINE, .words = "reservations about the result"},
    {LOAD_VALUE("friction_coefficient", fg_break_away, friction),
     .words = "slope of break-away friction over dead weight"},
    {LOAD_VALUE("friction_no_weight_n", fg_break_away, intercept_n),
     .words = "intercept, less the rig's friction"},
    {FG_NUMBER("rig_friction_n", fg_break_away, rig_n),
     .words = "at the rotor's surface; null: not given"},
    {FG_NUMBER("residual_sd_n", fg_break_away, residual_n), .words = "about the line",
     .options = FG_MEMBER_NOT_NEGATIVE},
    {FG_NUMBER("p_curved", fg_break_away, p_curved),
     .words =
         "probability that a straight line shows such a curve; null: too few weights or pulls"},
};
static const fg_members break_away_members = FG_MEMBERS(break_away_rows);

static fg_subject find_break_away(const fg_subject *subject) {
  const fg_load_bearing *b = subject->object;
  return (fg_subject){.object = b->break_away.pulls ? &b->break_away : NULL,
                      .whole = subject->whole};
}

static int judge_bearing(const fg_subject *subject) {
  return (int)fg_load_judge_bearing(test_of(subject), subject->index);
}

static const char *find_axis_words(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_load_axis_words(((const fg_load_bearing *)subject->object)->axis);
}

static const fg_member bearing_rows[] = {
    {FG_TEXT("name", fg_load_bearing, name), .words = "as the files or the options name it"},
    {FG_WORD_BY("verdict", judge_bearing, fg_verdict_words), .words = FG_VERDICT_WORDS,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT("azimuths", fg_load_bearing, directions), .words = "directions of its tests"},
    {FG_COUNT("azimuths_measured", fg_load_bearing, measured), .words = "those with a clearance"},
    {LOAD_VALUE("clearance_min_mm", fg_load_bearing, min), .words = "smallest of the directions"},
    {FG_NUMBER("clearance_min_at_deg", fg_load_bearing, min_measured_at_deg),
     .words = "its direction"},
    {LOAD_VALUE("clearance_max_mm", fg_load_bearing, max), .words = "largest of the directions"},
    {FG_NUMBER("clearance_max_at_deg", fg_load_bearing, max_measured_at_deg),
     .words = "its direction"},
    {FG_NUMBER_U("clearance_mean_mm", fg_load_bearing, mean_mm, u_mean_mm),
     .words = "over the directions"},
    {FG_NUMBER("p_alike", fg_load_bearing, p_value),
     .words = "p-value of equal clearances in all directions; null: too few"},
    {FG_LIST_BY("harmonics", find_harmonic, &harmonic_members), .options = FG_MEMBER_ON_LINE,
     .words = "of the clearance over the azimuths"},
    {FG_NUMBER_U("smallest_at_deg", fg_load_bearing, min_at_deg, u_min_at_deg),
     .words = "axis of the smallest clearance, 0 to 180: the opposite direction is as small"},
    {FG_TEXT_BY("smallest_not_known", find_axis_words),
     .words = "reason why smallest_at_deg is null"},
    {FG_NUMBER("birge_ratio", fg_load_bearing, birge),
     .words = "scatter of the cycles over that expected of their samples"},
    {LOAD_VALUE("stiffness_n_mm", fg_load_bearing, stiffness), .words = "mean over the directions"},
    {LOAD_VALUE("radial_hysteresis_n", fg_load_bearing, hysteresis_n),
     .words = "half of what lies between the strokes without load: friction of foils and rig; no "
              "preload"},
    {FG_NUMBER_U("friction_intercept_n", fg_load_bearing, hysteresis_n.value,
                 hysteresis_n.u_repeat),
     .words = "radial_hysteresis_n once more; its u is that of the repeats"},
    {FG_NUMBER_U("friction_slope", fg_load_bearing, slope, u_slope), .words = "per newton of load"},
    {FG_PART("break_away", find_break_away, &break_away_members),
     .words = "break-away test; null: none was given"},
    {LOAD_VALUE("preload_n", fg_load_bearing, preload_n),
     .words = "of the break-away test: friction without a weight over the friction coefficient; "
              "null without such a test"},
    {LOAD_VALUE("preload_kpa", fg_load_bearing, preload_kpa), .words = "preload_n over pi D L"},
    {FG_FLAG("in_lot", fg_load_bearing, in_lot), .words = "the lot has a bearing of this name"},
    {FG_COUNT("places_unknown", fg_load_bearing, unknown_places),
     .words = "places of the lot's bearing without a measured foil"},
};
static const fg_members bearing_members = FG_MEMBERS(bearing_rows);

/* The options of the run. */
static double find_u_stiffness(const fg_subject *subject) {
  const fg_load_options *o = subject->object;
  return hypot(o->u_force_pct, o->u_displacement_pct);
}

static double find_lever(const fg_subject *subject) {
  const fg_load_options *o = subject->object;
  return isfinite(o->lever_mm) ? o->lever_mm : o->diameter_mm / 2;
}

static double find_u_rig_torque(const fg_subject *subject) {
  const fg_load_options *o = subject->object;
  return isfinite(o->rig_n_mm) ? o->u_rig_n_mm : NAN;
}

static const fg_member limit_rows[] = {
    {FG_TEXT("quantity", fg_tolerance, quantity), .words = "that is judged"},
    {FG_NUMBER("min", fg_tolerance, lower), .words = "null: no lower limit"},
    {FG_NUMBER("max", fg_tolerance, upper), .words = "null: no upper limit"},
};
static const fg_members limit_members = FG_MEMBERS(limit_rows);

static const fg_member option_rows[] = {
    {FG_NUMBER("threshold_n", fg_load_options, threshold_n), .words = "force of a contact"},
    {FG_NUMBER("u_force_pct", fg_load_options, u_force_pct), .words = "of the load cell's scale"},
    {FG_NUMBER("u_displacement_pct", fg_load_options, u_displacement_pct),
     .words = "of the probe's scale"},
    {FG_NUMBER_BY("u_stiffness_pct", find_u_stiffness), .words = "both together"},
    {FG_NUMBER("diameter_mm", fg_load_options, diameter_mm), .words = "of the bore"},
    {FG_NUMBER("length_mm", fg_load_options, length_mm), .words = "of the bore"},
    {FG_NUMBER("azimuth_zero_deg", fg_load_options, azimuth_zero_deg),
     .words = "azimuth of the lot's direction 0"},
    {FG_NUMBER("u_weight_pct", fg_load_options, u_weight_pct),
     .words = "standard uncertainty of the dead weights' scale"},
    {FG_NUMBER_BY("lever_mm", find_lever),
     .words = "radius that a break-away test's force pulls at"},
    {FG_NUMBER("rig_torque_n_mm", fg_load_options, rig_n_mm), .u = find_u_rig_torque,
     .words = "friction torque of the rig; null: not given, it counts as preload"},
    {FG_ARRAY("limits", fg_load_options, limits, limit_count, &limit_members),
     .options = FG_MEMBER_ON_LINE, .words = "as the options state them"},
};
static const fg_members option_members = FG_MEMBERS(option_rows);

/* The report. */
static const fg_member file_rows[] = {
    {FG_STRING("path", fg_load_file, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT("sha256", fg_load_file, sha256)},
    {FG_STRING("columns_not_read", fg_load_file, not_read), .words = "null: none"},
};
static const fg_members file_members = FG_MEMBERS(file_rows);

static const fg_member lot_rows[] = {
    {FG_STRING("path", fg_load_test, options.lot), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT("sha256", fg_load_test, lot_sha256), .words = "of its lot.json"},
};
static const fg_members lot_members = FG_MEMBERS(lot_rows);

static fg_subject find_lot(const fg_subject *subject) {
  return (fg_subject){.object = test_of(subject)->options.lot ? subject->object : NULL};
}

static fg_verdict judge_test(const fg_subject *subject) {
  fg_report_outcome outcome;
  fg_load_judge(subject->object, &outcome, NULL, 0);
  return outcome.verdict;
}

static double find_in_tolerance(const fg_subject *subject) {
  return fg_is_in_tolerance(judge_test(subject));
}

static int find_verdict(const fg_subject *subject) {
  return (int)judge_test(subject);
}

static const char *find_summary(const fg_subject *subject, char *buffer) {
  fg_report_outcome outcome;
  fg_load_judge(subject->object, &outcome, buffer, 300);
  return buffer;
}

static const fg_member test_rows[] = {
    {FG_HEAD("foilgauge/load_test/1")},
    {FG_FLAG_BY("in_tolerance", find_in_tolerance), .options = FG_MEMBER_NULLABLE,
     .words = FG_IN_TOLERANCE_WORDS},
    {FG_WORD_BY("verdict", find_verdict, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_VERDICT_WORDS},
    {FG_TEXT_BY("summary", find_summary), .options = FG_MEMBER_NEVER_NULL,
     .words = "outcome in a sentence"},
    {FG_LIST("inputs", fg_load_test, files, file_count, &file_members),
     .words = "files that were read"},
    {FG_PART("lot", find_lot, &lot_members), .options = FG_MEMBER_LEFT_OUT,
     .words = "lot that predicts the clearances"},
    {FG_OBJECT("options", fg_load_test, options, &option_members)},
    {FG_LIST("bearings", fg_load_test, bearings, bearing_count, &bearing_members)},
    {FG_LIST("azimuths", fg_load_test, directions, direction_count, &fg_load_direction_members),
     .words = "directions of all bearings"},
};
static const fg_members test_members = FG_MEMBERS(test_rows);

const fg_document fg_load_document = {
    .file = "load_test",
    .title = "foilgauge stiffness report",
    .description =
        "Units are in the names. u_ is a standard uncertainty, u_repeat_ the same without "
        "the instruments' scale. null is a value that is not known.",
    .made_by = "`foilgauge stiffness`",
    .members = &test_members,
};

fg_status fg_load_write_json(fg_context *ctx, const fg_load_test *test, FILE *out) {
  fg_document_json(out, &test_members, test);
  return fg_stream_finish(ctx, out, "the JSON report");
}
