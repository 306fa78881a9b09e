/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas film under a bearing's foils, and the stability of a rotor on it (thesis section 5.12).
 *
 * FILM. Isothermal compressible Reynolds equation on the unwrapped bearing, R = D/2:
 *   d/dx (p h³ dp/dx) + d/dz (p h³ dp/dz) = 6 mu omega R d(p h)/dx + 12 mu d(p h)/dt,
 * ambient pressure p_a at both ends and at every edge of a pad. Groups of the literature:
 *   compressibility number  L = 6 mu omega (R / C)² / p_a
 *   compliance              alpha = p_a s / (C K), s the bumps' pitch, K a bump's stiffness per
 *                           width (foilgauge/stiffness.h)
 *   loss factor             gamma: a bump's stiffness is K (1 + i gamma) while the rotor whirls
 * C is the reference clearance. The clearance is linear from bump to bump and constant beyond the
 * outer ones of a pad. The top foil does not bend along the axis (Kim and San Andrés 2006: the mean
 * pressure over the length deflects it); along the rotation it is stiff between the bumps, or sags
 * as a beam on them, held at its leading edge. Neither lifts off the bumps, the gas stays at one
 * temperature, the axes are parallel.
 *
 * SIGNS. Directions as in foilgauge/bearing.h: 0 degrees at the first bump of pad 1, the rotor
 * turns towards larger angles. The load is the force on the rotor; the attitude angle leads from
 * the load to the displaced rotor, in the sense of rotation.
 *
 * ROTOR. Rigid, one half of its mass on each of two like bearings; rotor_mass_kg is the mass on one
 * of them. Stiffness and damping at a whirl of nu times the speed are the film's first-order
 * response (Lund 1968): force = -(K + i nu omega C) displacement. The rotor is on the border of
 * stability where an eigenvalue of this impedance is real: then it is M (nu omega)², M the critical
 * mass (Pan 1964), and every heavier rotor whirls. The threshold speed is the lowest at which the
 * rotor's mass is critical. Beside it stand the eigenvalues of the rotor on its film, M s² + Z(s)
 * = 0: on the border both methods have the same s, away from it the eigenvalues tell how fast a
 * whirl decays or grows.
 */
#ifndef FOILGAUGE_FILM_H
#define FOILGAUGE_FILM_H

#include <stdint.h>
#include <stdio.h>

#include "foilgauge/bearing.h"
#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The top foil between the bumps, along the rotation. */
typedef enum fg_film_top_foil {
  FG_FILM_TOP_FOIL_STIFF,   /* straight from bump to bump */
  FG_FILM_TOP_FOIL_SAGGING, /* a beam on the bumps */
} fg_film_top_foil;

enum {
  FG_FILM_FREQUENCIES = 21,
  FG_FILM_MODES = 4,
  FG_FILM_SPEEDS_MAX = 200,
  FG_FILM_TURNS_MAX = 10000
};

/* Speeds at which the stability map is solved, in equal ratios. */
typedef struct fg_film_map_options {
  double low_rpm, high_rpm; /* NaN: a quarter and four times the bearing's speed */
  size_t speeds;
} fg_film_map_options;

/* Bearings drawn at random: with shims of random heights under the bumps, or of a lot's foils. */
typedef struct fg_film_draw_options {
  size_t count;                       /* 0: none */
  double shim_low_pct, shim_high_pct; /* heights, percent of the clearance; NaN: no shims */
  const char *keep; /* file of solved bearings, which a run goes on from and adds to; NULL: none */
  size_t shard, shards; /* draws shard - 1, shard - 1 + shards, ... alone; shards 0: all */
} fg_film_draw_options;

/* Speed at which a coasting rotor was measured to touch down. */
typedef struct fg_film_lift_off_options {
  double rpm, u_rpm; /* NaN: not measured */
  double u_load_n;   /* of the load at that speed */
} fg_film_lift_off_options;

typedef struct fg_film_options {
  double load_n, load_deg, speed_rpm; /* load_n, speed_rpm above 0 */
  double rotor_mass_kg;               /* NaN: load / 9.80665 m/s² */
  double length_mm;                   /* NaN: the rotor's diameter */
  double clearance_um;                /* reference; NaN: the design's C_D */
  double compliance;                  /* NaN: of the design's bumps */
  const char *model;                  /* of a bump's stiffness, by its id; NULL: the arch */
  fg_arch_material material;
  double loss_factor;
  double viscosity_upa_s, ambient_kpa;
  size_t pads; /* 0: a closed ring of bumps, without edges */
  size_t bumps_per_pad, first_bump;
  double pitch_deg;
  fg_film_top_foil top_foil;
  double top_foil_mm;                 /* NaN: the design's; of a top foil that sags */
  size_t cells_per_bump, cells_axial; /* mesh: even; over half the length */
  double touching_um;                 /* a thinner film touches */
  fg_film_map_options map;
  /* A report of measured foils, whose order is that of the pads; or the folder of a lot, whose
   * foils bearings are drawn from. NULL: as designed. */
  const char *foils;
  const struct fg_film_stock *stock; /* such foils in memory, in place of a folder; NULL: none */
  /* Measured profile of the bore, CSV with angle_deg and radius_mm: its radius less the design's
   * sleeve_radius_mm is added to the clearance. NULL: round, as designed. */
  const char *bore;
  fg_film_lift_off_options lift_off;
  fg_film_draw_options draw;
  uint64_t seed;      /* of all random numbers */
  unsigned jobs;      /* threads; 0: all cores */
  size_t orbit_turns; /* of the orbit in time; 0: none */
  double within_pct;  /* change of the threshold speed that a tolerance on the clearance is asked
                         for; NaN: none is */
  bool sensitivity;   /* of the critical mass, over the shape of the bumps */
} fg_film_options;

/* Air at 25 degrees C; table 5.6's loss factor, three pads of seven bumps or of as many as the
 * design has. */
fg_film_options fg_film_options_default(void);

/* A bearing: its places, clearances and bumps. */
typedef struct fg_film_bearing {
  size_t count;
  double angle_deg[FG_BEARING_BUMPS_MAX], clearance_mm[FG_BEARING_BUMPS_MAX];
  double stiffness_n_mm2[FG_BEARING_BUMPS_MAX];
} fg_film_bearing;

typedef enum fg_film_outcome {
  FG_FILM_SOLVED,
  FG_FILM_TOUCHING, /* solved, with a film thinner than touching_um */
  FG_FILM_UNSOLVED, /* no steady film was found at this load */
} fg_film_outcome;
extern const char *const fg_film_outcome_words[]; /* "solved", "touching", "unsolved", NULL */

/* A bearing's threshold speed, compared with the perfect one's ± within_pct. */
typedef enum fg_film_threshold_verdict {
  FG_FILM_THRESHOLD_NOT_ASKED,
  FG_FILM_THRESHOLD_NO_FILM, /* or one that touches, at an end of that range */
  FG_FILM_THRESHOLD_BELOW,
  FG_FILM_THRESHOLD_WITHIN,
  FG_FILM_THRESHOLD_ABOVE,
} fg_film_threshold_verdict;

/* A bearing at one speed and load; NaN where unsolved. */
typedef struct fg_film_result {
  fg_film_outcome outcome;
  double speed_rpm, compressibility;
  double place_um[2];  /* of the rotor */
  double eccentricity; /* over the reference clearance */
  double attitude_deg;
  double min_film_um, min_film_deg, max_pressure_kpa, power_w;
  double critical_mass_kg;  /* infinite: stable at every mass; 0: unstable at every mass */
  double stable_again_kg;   /* heavier rotors do not whirl; infinite: all above the critical mass do
                             */
  double whirl_ratio;       /* of the whirl at the critical mass, over the speed */
  double log_decrement;     /* of the rotor's least stable whirl; NaN: not asked, or none; minus
                               infinite where it falls off its place */
  double mass_over_perfect; /* critical mass over the perfect bearing's; NaN: not asked */
  fg_film_threshold_verdict threshold;
  size_t draw; /* its number, from 1; 0: no drawn bearing */
} fg_film_result;

/* Returns true for a rotor that does not whirl on a bearing at its speed; false where unsolved. */
static inline bool fg_film_is_stable(const fg_film_result *result, double mass_kg) {
  return mass_kg < result->critical_mass_kg || mass_kg > result->stable_again_kg;
}

/* Returns true for a film between two others that no rotor rests on: it falls off without a whirl.
 */
static inline bool fg_film_falls_off(const fg_film_result *result) {
  return result->critical_mass_kg == 0 && result->whirl_ratio == 0;
}

/* Stiffness and damping at one frequency of whirl; xx, xy, yx, yy. */
typedef struct fg_film_coefficients {
  double whirl_ratio, frequency_hz;
  double stiffness_n_um[4], damping_n_s_mm[4];
} fg_film_coefficients;

typedef enum fg_film_direction { FG_FILM_FORWARD, FG_FILM_BACKWARD } fg_film_direction;
extern const char *const fg_film_direction_words[]; /* "forward", "backward", NULL */

/* A whirl of the rotor on its film by itself: an eigenvalue of both. */
typedef struct fg_film_mode {
  double whirl_ratio, frequency_hz;
  double log_decrement; /* of the amplitude, from whirl to whirl; below 0 it grows */
  double damping_ratio; /* less the real part over the size of the eigenvalue */
  fg_film_direction direction;
} fg_film_mode;

/* A line of nodes across the film. */
typedef struct fg_film_column {
  size_t pad;
  double angle_deg, clearance_um, film_um, deflection_um;
  double *pressure_kpa; /* from the middle to the end of the length */
} fg_film_column;

typedef struct fg_film_share {
  size_t count;
  double share, low, high; /* interval of 95 % (Clopper and Pearson) */
} fg_film_share;

enum { FG_FILM_QUANTILES = 5 };

typedef struct fg_film_draws {
  fg_film_result *result;
  size_t count, asked;    /* fewer are there than asked for where this is a part of them */
  size_t kept;            /* of an earlier run */
  size_t foils, left_out; /* of a lot: in stock, and others; 0: random shims */
  fg_film_share solved, touching, more_stable, less_stable; /* the latter two of those solved */
  /* Of all: with a threshold speed within within_pct of the perfect bearing's; lower by no more. */
  fg_film_share within, not_lower;
  double quantile[FG_FILM_QUANTILES]; /* of the critical mass over the perfect bearing's: 5, 25, 50,
                                         75, 95 % of those solved */
} fg_film_draws;

/* Sensitivity of the critical mass to a parameter of the design's bumps. */
typedef enum fg_film_parameter {
  FG_FILM_RADIUS,
  FG_FILM_ANGLE,
  FG_FILM_RADIUS_AT_ARC, /* as springback changes it */
  FG_FILM_THICKNESS,
  FG_FILM_PARAMETERS
} fg_film_parameter;
extern const char *const fg_film_parameter_words[];

typedef struct fg_film_sensitivity {
  fg_film_parameter parameter;
  /* Per percent of the parameter, of all bumps alike. */
  double clearance_um_per_pct, stiffness_pct_per_pct, mass_pct_per_pct;
  /* Bearings whose bumps scatter by one percent (standard deviation), independently: those solved
   * of 200, and their critical mass over the perfect bearing's, quantiles as of draws. */
  fg_film_share solved;
  double quantile[FG_FILM_QUANTILES];
} fg_film_sensitivity;

/* The widest tolerance that is tried, of the reference clearance. */
#define FG_FILM_WIDEST_SHARE 0.5

/* Tolerances on the clearance that keep the threshold speed within within_pct of the perfect
 * bearing's; infinite: all that were tried keep it. */
typedef struct fg_film_tolerance {
  bool asked;
  double threshold_rpm; /* of the perfect bearing; NaN: none among the speeds, nor the others */
  /* ± at every bump by itself (uniform): 95 of 100 bearings keep it; are lower by no more. */
  double each_um, each_not_lower_um;
  double alike_um[2]; /* all bumps alike: how much closer, how much wider */
} fg_film_tolerance;

/* Standard uncertainties of a measured bearing's results by those of its clearances, by drawing:
 * every bump errs by itself, the thickness with all. */
typedef struct fg_film_uncertainty {
  size_t draws; /* 0: nothing was measured, or without u */
  fg_film_share solved;
  double eccentricity, min_film_um, max_pressure_kpa, power_w, critical_mass_kg, whirl_ratio;
  double mass_low_kg, mass_high_kg; /* interval of 95 % of the critical mass */
} fg_film_uncertainty;

/* A measured lift-off speed against the bearing's: the shift of all its clearances with which the
 * film is touching_um thick at that speed, under the same load. */
typedef struct fg_film_lift_off {
  bool asked;
  double rpm, u_rpm;                     /* as measured */
  double predicted_rpm, u_predicted_rpm; /* u by those of clearances and load; NaN: not known */
  double shift_um, u_shift_um;           /* u by those of speed and load */
  double u_by_load_um;                   /* the load's part of it */
  double clearance_um;                   /* mean over the bumps, shifted */
  double u_bearing_um;                   /* of the bearing's mean clearance, before */
  bool agrees;                           /* no shift is shown: within 2 u of all */
} fg_film_lift_off;

/* A place of the rotor's orbit. */
typedef struct fg_film_orbit_place {
  double turn, place_um[2], min_film_um;
} fg_film_orbit_place;

typedef enum fg_film_fate {
  FG_FILM_DECAYS,
  FG_FILM_GROWS,
  FG_FILM_CYCLES,       /* the amplitude stays */
  FG_FILM_TOUCHES,      /* the film ends before the turns do */
  FG_FILM_FATE_UNKNOWN, /* too few whirls in these turns */
} fg_film_fate;
extern const char *const fg_film_fate_words[]; /* "decays", "grows", ..., NULL */

/* The rotor's orbit in time about its steady place, after a pulse of 2 % of the load during the
 * first turn. The loss factor has no equation in time: viscous bumps lose as much at the rotor's
 * least damped whirl. */
typedef struct fg_film_orbit {
  fg_film_orbit_place *point;
  size_t count; /* 0: not asked */
  fg_film_fate fate;
  double growth_per_turn; /* logarithm of the amplitude; NaN: not known */
  double whirl_ratio;
} fg_film_orbit;

typedef struct fg_film_report {
  fg_design design;
  fg_film_options options;
  char foils_path[512], foils_sha256[65];
  double clearance_um, compliance, stiffness_n_mm2, length_mm, diameter_mm;
  fg_film_bearing bearing;
  /* Standard uncertainties of its clearances: own, and shared by all bumps; 0: as designed. */
  double u_own_mm[FG_BEARING_BUMPS_MAX], u_shared_mm[FG_BEARING_BUMPS_MAX];
  fg_film_uncertainty uncertainty;
  fg_film_tolerance tolerance;
  fg_film_result perfect; /* the bearing as designed */
  fg_film_result actual;  /* with its measured foils and bore; without them the perfect one */
  fg_film_coefficients coefficients[FG_FILM_FREQUENCIES]; /* by frequency of whirl */
  size_t coefficient_count;                               /* 0 where unsolved */
  fg_film_result *by_speed;                               /* of the stability map; owned */
  size_t speed_count;
  double threshold_rpm;             /* NaN: not within the speeds */
  double threshold_eigen_rpm;       /* by the least stable eigenvalue; NaN likewise */
  fg_film_mode mode[FG_FILM_MODES]; /* at this speed, the least stable one first */
  size_t modes;
  /* Largest load at this speed, and lowest speed under this load, with any film of touching_um at
   * least; NaN: not found, or it touches already. */
  double load_capacity_n, lift_off_rpm;
  /* Ends of the bearing's own film on the way there, where the rotor passes to another one; NaN:
   * it does not. */
  double film_ends_n, film_ends_rpm;
  bool has_other_film;       /* at this load and speed, with the rotor at another place: */
  fg_film_result other_film; /* that one */
  fg_film_lift_off lift_off;
  char bore_path[512], bore_sha256[65];
  double bore_shift_mm[FG_BEARING_BUMPS_MAX]; /* at the bearing's places */
  fg_film_column *column;
  size_t columns, nodes; /* nodes of a column */
  double *pressure_kpa;  /* of all columns; owned */
  fg_film_draws draws;
  fg_film_orbit orbit;
  fg_film_sensitivity sensitivity[FG_FILM_PARAMETERS];
  size_t sensitivities; /* 0: not asked */
} fg_film_report;

/* Solves the film of the bearing as designed and as measured, and what else the options ask for.
 * FG_ERR_DATA for a design without bumps or a bearing without clearance, FG_ERR_USAGE for
 * options that contradict each other, FG_ERR_NUMERIC when the perfect bearing has no film at this
 * load. */
fg_status fg_film_run(fg_context *ctx, const fg_design *design, const fg_film_options *options,
                      fg_film_report *report);
void fg_film_report_free(fg_film_report *report);

/* True where foils of one bearing, or its bore, are measured. */
bool fg_film_is_measured(const fg_film_options *options);

/* True where `foils` is the folder of a lot. */
bool fg_film_draws_from_lot(const fg_film_options *options);

/* Solved, touching: 0. Unsolved: 2. */
int fg_film_exit_code(const fg_film_report *report);

fg_status fg_film_write_json(fg_context *ctx, const fg_film_report *report, FILE *out);
fg_status fg_film_write_html(fg_context *ctx, const fg_film_report *report, FILE *out);
fg_status fg_film_write_text(fg_context *ctx, const fg_film_report *report, FILE *out);
/* Row per drawn bearing; per speed; per place of the orbit. */
fg_status fg_film_write_draws(fg_context *ctx, const fg_film_report *report, FILE *out);
fg_status fg_film_write_orbit(fg_context *ctx, const fg_film_report *report, FILE *out);
fg_status fg_film_write_speeds(fg_context *ctx, const fg_film_report *report, FILE *out);

#ifdef __cplusplus
}
#endif
#endif
