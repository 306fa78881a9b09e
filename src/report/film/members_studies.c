/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of studies of a film: whirls, tolerances on the clearance, uncertainty, sensitivities. */
#include "report/film/members.h"

static double is_stable(const fg_subject *s) {
  return ((const fg_film_mode *)s->object)->log_decrement > 0;
}

#define MODE(name, field, heading_, digits_)                                                       \
  FG_NUMBER(name, fg_film_mode, field), .heading = (heading_),                                     \
                                        .page = {.rank = 1, .digits = (digits_)},                  \
                                        .terminal = {.rank = 1, .digits = (digits_)}

static const fg_member mode_rows[] = {
    {MODE("frequency_hz", frequency_hz, "whirl,\nHz", 4), .words = "of the whirl"},
    {MODE("whirl_ratio", whirl_ratio, "over the\nspeed", 4), .words = "whirl over speed"},
    {FG_WORD("direction", fg_film_mode, direction, fg_film_direction_words),
     .words = "forward: with the rotor's rotation", .heading = "direction", .page = {.rank = 1},
     .terminal = {.rank = 1}},
    {MODE("log_decrement", log_decrement, "log.\ndecrement", 3),
     .words = "logarithm of an amplitude over that of one whirl later; below 0 it grows"},
    {MODE("damping_ratio", damping_ratio, "damping\nratio", 3),
     .words = "less the real part over the size of the eigenvalue; below 0 it grows"},
    {FG_FLAG_BY("stable", is_stable), .heading = "stable", .page = {.rank = 2},
     .terminal = {.rank = 2}},
};
const fg_members fg_film_mode_members = FG_MEMBERS(mode_rows);

bool fg_film_mode_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &((const fg_film_report *)list->whole)->mode[i];
  return i < ((const fg_film_report *)list->whole)->modes;
}

static double within_of(const fg_subject *s) {
  return ((const fg_film_report *)s->whole)->options.within_pct;
}

static const fg_member tolerance_rows[] = {
    {FG_NUMBER_BY("within_pct", within_of), .words = "of the threshold speed, as asked"},
    {FG_NUMBER("threshold_rpm", fg_film_tolerance, threshold_rpm),
     .words = "of the bearing as designed; null: none among the speeds, and so no tolerance"},
    {FG_NUMBER("each_um", fg_film_tolerance, each_um),
     .words = "± of the clearance at every bump by itself, uniform, with which 95 of 100 bearings "
              "keep it; null: half of the clearance keeps it"},
    {FG_NUMBER("each_not_lower_um", fg_film_tolerance, each_not_lower_um),
     .words = "the same, where a higher threshold is welcome"},
    {FG_NUMBER("alike_closer_um", fg_film_tolerance, alike_um[0]),
     .words = "of all bumps alike; null: half of the clearance keeps it"},
    {FG_NUMBER("alike_wider_um", fg_film_tolerance, alike_um[1])},
};
const fg_members fg_film_tolerance_members = FG_MEMBERS(tolerance_rows);

static const fg_member lift_off_rows[] = {
    {FG_NUMBER_U("measured_rpm", fg_film_lift_off, rpm, u_rpm), .words = "as stated"},
    {FG_NUMBER_U("predicted_rpm", fg_film_lift_off, predicted_rpm, u_predicted_rpm),
     .words = "of the bearing; u by those of its clearances and of the load; null: not known"},
    {FG_NUMBER_U("clearance_shift_um", fg_film_lift_off, shift_um, u_shift_um),
     .words = "of all bumps alike, with which the bearing lifts off at the measured speed; u by "
              "those of the speed and the load; null: none within 0.6 of the clearance"},
    {FG_NUMBER("u_by_load_um", fg_film_lift_off, u_by_load_um),
     .words = "the load's part of that u"},
    {FG_NUMBER("clearance_um", fg_film_lift_off, clearance_um),
     .words = "mean over the bumps, so shifted"},
    {FG_NUMBER("u_bearing_um", fg_film_lift_off, u_bearing_um),
     .words = "of that mean as it was measured on the foils; 0: as designed, or without u"},
    {FG_FLAG("agrees", fg_film_lift_off, agrees),
     .words = "the shift is within twice the u of speed, load and clearances together"},
};
const fg_members fg_film_lift_off_members = FG_MEMBERS(lift_off_rows);

static const fg_member uncertainty_rows[] = {
    {FG_COUNT("draws", fg_film_uncertainty, draws), .words = "of the clearances within their u"},
    {FG_OBJECT("solved", fg_film_uncertainty, solved, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .words = "of them with a steady film"},
    {FG_NUMBER("u_eccentricity_ratio", fg_film_uncertainty, eccentricity)},
    {FG_NUMBER("u_min_film_um", fg_film_uncertainty, min_film_um)},
    {FG_NUMBER("u_max_pressure_kpa", fg_film_uncertainty, max_pressure_kpa)},
    {FG_NUMBER("u_power_loss_w", fg_film_uncertainty, power_w)},
    {FG_NUMBER("u_critical_mass_kg", fg_film_uncertainty, critical_mass_kg),
     .words = "of those with a critical mass"},
    {FG_NUMBER("u_whirl_ratio", fg_film_uncertainty, whirl_ratio)},
    {FG_RANGE("critical_mass_95_kg", fg_film_uncertainty, mass_low_kg, mass_high_kg),
     .words = "interval of 95 %; null where drawn bearings are unsolved or stable at every mass"},
};
const fg_members fg_film_uncertainty_members = FG_MEMBERS(uncertainty_rows);

#define SENSITIVITY(name, field, heading_)                                                         \
  FG_NUMBER(name, fg_film_sensitivity, field), .heading = (heading_),                              \
                                               .page = {.rank = 2, .digits = 3},                   \
                                               .terminal = {.rank = 2, .digits = 3}

static const fg_member sensitivity_rows[] = {
    {FG_WORD("parameter", fg_film_sensitivity, parameter, fg_film_parameter_words),
     .words = "of the design's bumps", .heading = "of", .page = {.rank = 1},
     .terminal = {.rank = 1}},
    {SENSITIVITY("clearance_um_per_pct", clearance_um_per_pct, "clearance,\nµm/%"),
     .words = "change of the clearance for one percent more, of all bumps"},
    {SENSITIVITY("stiffness_pct_per_pct", stiffness_pct_per_pct, "stiffness,\n%/%"),
     .words = "of a bump, likewise"},
    {SENSITIVITY("mass_pct_per_pct", mass_pct_per_pct, "critical\nmass, %/%"),
     .words = "of the critical mass, likewise"},
    {FG_OBJECT("scatter_solved", fg_film_sensitivity, solved, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "of 200 bearings whose bumps scatter by one percent (standard deviation)"},
    {SENSITIVITY("scatter_at_5_pct", quantile[0], "scatter 1 %:\n5 %"),
     .words = "5 % quantile of their critical mass over the perfect bearing's"},
    {SENSITIVITY("scatter_median", quantile[2], "median"), .words = "their median"},
    {SENSITIVITY("scatter_at_95_pct", quantile[4], "95 %"), .words = "their 95 % quantile"},
};
const fg_members fg_film_sensitivity_members = FG_MEMBERS(sensitivity_rows);

bool fg_film_sensitivity_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &((const fg_film_report *)list->whole)->sensitivity[i];
  return i < ((const fg_film_report *)list->whole)->sensitivities;
}
