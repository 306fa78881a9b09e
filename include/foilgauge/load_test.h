/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load-displacement tests of an assembled bearing (thesis section 5.13): a rotor that does not turn
 * is pushed and pulled along an azimuth, force and displacement are recorded, several cycles.
 *
 * STROKES. A record is cut where the displacement turns. Up strokes push, down strokes pull. While
 * |F| grows a stroke loads; before that, returning to the middle, it unloads.
 *
 * CLEARANCE. Travel between the points where the loading strokes pass +T and -T, T the threshold. A
 * point is where a local quadratic regression of F over x says T. Over the strokes j, numbered in
 * time, the points are
 *   x_j = push + d j (up strokes),   x_j = pull + d j (down strokes),   clearance = push - pull:
 * one drift d for both removes creep (of the sensor, or of the force's zero over the local
 * stiffness). T counts from the load cell's zero: the mean of up and down strokes where its slope
 * is smallest, if that is less than half of the largest slope. A zero beyond half of T, friction of
 * T and more without a foil, loops that give energy: no clearance is named. Friction shifts the
 * unloading points; their travel is reported separately.
 *
 * GAP. Free travel of the rotor, smaller than the clearance by the deflection of both foils under
 * T: it ends where the loaded branches, as the mean of loading and unloading, reach zero force. A
 * branch is followed by x0 + p F^(1/n) + q F^(2/n), n from 1 (a spring) to 2; the influence of n on
 * x0 is in u. A gap that does not exceed its U is not shown: both foils may press the rotor at
 * once, the travel between +T and -T is then theirs, and no clearance is named.
 *
 * STIFFNESS. dF/dx of the loading strokes by the same regression; structural stiffness is its
 * largest value up to just before the turn: 1 % of the travel, or ten times the displacement's
 * noise where that is more, is left out there, and a foil that hardens is stiffer beyond. The place
 * is chosen on the other cycles than the one whose value is used there (the halves of one cycle's
 * samples, where there is but one): the largest of noisy values is biased upward.
 *
 * UNSAMPLED STRETCHES, of a dropout or of a rotor that jumps through the gap under load control. No
 * regression reaches over one: a contact is found on its own side's loaded branch. A threshold that
 * is passed within one lies where the force, which rises and no more than twice as steeply as
 * beside it, may pass it: a rectangular distribution, in u, and a flag. Contacts that contradict
 * each other (push and pull on one side of the gap; unloading inside of loading, or further out
 * than friction over the stiffness) withhold the clearance.
 *
 * THE WINDOW of a regression grows as long as the intervals of all windows so far have a value in
 * common (A. Goldenshluger, A. Nemirovski, On spatially adaptive estimation of nonparametric
 * regression, Math. Methods Statist. 6, 1997; intersection of confidence intervals).
 *
 * LOSS FACTORS OF THE TEST. Loop area over pi K X²: K the structural stiffness, X half of the
 * travel, gap included: the same foil has a smaller one behind a wider gap. With K of the loop's
 * ends (secant) it is reported beside. The force of an end is that at the turn of its loading
 * branch, its place is from a regression of the displacement over the force: the extreme of noisy
 * displacements lies beyond the turn.
 *
 * LOSS FACTOR OF THE FOIL. Of the compression alone, independent of the gap: energy lost in
 * compressing both sides' foils and letting them go, over 2 pi times the elastic work, the mean of
 * that of loading and of unloading (Ungar and Kerwin, 1962). Comparable with the loss factor gamma
 * of a foil in models (thesis table 5.6). Friction in the gap is the rig's, and is excluded.
 *
 * RADIAL HYSTERESIS. Half of the difference between the strokes is friction, of the foils and of
 * the rig. Over the mean force M of both, H = (a + b |M|) (1 - exp(-s/l) - exp(-s'/l)), s and s'
 * the travel since each stroke turned, l the travel over which friction reverses. a is the radial
 * hysteresis of a bearing without load; where there is a gap it is the mean of H over the gap. It
 * does not reveal a preload: a rig's friction adds to a just as a preload's does, and b is that of
 * sliding feet, not of the rotor in its foils.
 *
 * PRELOAD. A break-away test (thesis section 6.2.2): dead weights W load the bearing, and the
 * torque is read at which the rotor begins to turn. Over the rotor's radius it is friction, F =
 * torque / (D/2) = mu (W + P) + rig, a straight line over W: its slope is the coefficient of
 * friction mu, its intercept less the rig's friction is mu P. The foils press the rotor with P
 * without a weight, over the bore's surface with p = P / (pi D L):   1.032 N / 0.03 / (pi 40 mm 40
 * mm) = 6.84 kPa   (thesis: 6.85). u of both follows from the residuals, with unequal scatter of
 * the weights allowed (HC3: J. S. Long, L. H. Ervin, Using heteroscedasticity consistent standard
 * errors in the linear regression model, The American Statistician 54, 2000), widened by Student's
 * t so that U = 2 u holds with few pulls.
 *
 * AZIMUTHS. Travel along an azimuth is that along the opposite one: azimuths are axes, taken modulo
 * 180 degrees, and the clearance has even orders only,
 *   clearance = c0 + sum of c_k cos k az + s_k sin k az, k = 2 from three axes on (0, 120 and 240
 * degrees are three), k = 4 too from six on. The axis of the smallest clearance is that of the
 * curve.
 *
 * UNCERTAINTY. u of a point follows from the scatter about the regression; where the cycles differ
 * by more than u implies, every u is widened (the Birge ratio, over all directions of a bearing).
 * The instruments' uncertainties are added, relative and standard: the optical probe's 1.3 % and
 * the load cell's 1.0 % (thesis sections 5.13 and 2.8), together 1.64 % of a stiffness; of a
 * clearance the displacement's, and the load cell's over the local stiffness. They are common to
 * all directions and do not enter differences over the azimuths. */
#ifndef FOILGAUGE_LOAD_TEST_H
#define FOILGAUGE_LOAD_TEST_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/design.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_LOAD_THRESHOLD_N        5.0
#define FG_LOAD_U_FORCE_PCT        1.0
#define FG_LOAD_U_DISPLACEMENT_PCT 1.3
#define FG_LOAD_U_WEIGHT_PCT       1.0
#define FG_LOAD_DIAMETER_MM        40.0
#define FG_LOAD_LENGTH_MM          40.0

/* File with facts that its columns may lack. */
typedef struct fg_load_source {
  const char *path;
  const char *bearing; /* used when it has no such column; NULL: the file's name */
  double azimuth_deg;  /* used when it has no such column; NaN: not stated */
} fg_load_source;

/* Quantities that limits may name. */
typedef enum fg_load_quantity {
  FG_LOAD_CLEARANCE, /* of every direction */
  FG_LOAD_STIFFNESS,
  FG_LOAD_LOSS,
  FG_LOAD_PRELOAD, /* of a bearing */
  FG_LOAD_HYSTERESIS,
  FG_LOAD_FRICTION,
  FG_LOAD_QUANTITIES,
} fg_load_quantity;

/* clearance_mm, stiffness_n_mm, loss_factor, preload_kpa, radial_hysteresis_n, friction_coefficient
 */
const char *fg_load_quantity_name(fg_load_quantity quantity);

enum { FG_LOAD_LIMITS_MAX = 16 };

typedef struct fg_load_options {
  double threshold_n;
  double u_force_pct, u_displacement_pct; /* standard uncertainties */
  double u_weight_pct;                    /* of a break-away test's dead weights */
  double lever_mm;                        /* of its force; NaN: half of the diameter */
  double rig_n_mm, u_rig_n_mm;            /* the rig's own torque; NaN: not known */
  double diameter_mm, length_mm;          /* of the bore */
  double azimuth_zero_deg;                /* azimuth of the lot's direction 0 */
  const char *lot;                        /* folder of a lot; NULL: none */
  const fg_load_source *break_away;       /* break-away tests; only read by fg_load_test_measure */
  size_t break_away_count;
  fg_tolerance limits[FG_LOAD_LIMITS_MAX];
  size_t limit_count;
} fg_load_options;

fg_load_options fg_load_options_default(void);

typedef struct fg_load_value {
  double value;
  double u;        /* standard uncertainty, instruments included */
  double u_repeat; /* without the instruments' scale: for comparing directions */
} fg_load_value;

/* Faults of a direction. */
enum {
  FG_LOAD_NO_CONTACT = 1 << 0,    /* |F| never passes the threshold */
  FG_LOAD_ONE_SIDE = 1 << 1,      /* pushed or pulled only */
  FG_LOAD_TOO_FEW = 1 << 2,       /* too few samples to regress */
  FG_LOAD_WRONG_WAY = 1 << 3,     /* loops that release energy */
  FG_LOAD_FORCE_TURNED = 1 << 4,  /* the force had the wrong sign and was negated */
  FG_LOAD_AT_END = 1 << 5,        /* stiffness is largest at the last place before the turn */
  FG_LOAD_FRICTION_HIGH = 1 << 6, /* friction in the middle is more than half of the threshold */
  FG_LOAD_ONE_CYCLE = 1 << 7,     /* repeatability unknown */
  FG_LOAD_ZERO_OFF = 1 << 8,      /* the load cell's zero exceeds half of the threshold */
  FG_LOAD_NO_GAP = 1 << 9,        /* both foils touch the rotor at once, or nearly */
  FG_LOAD_UNITS = 1 << 10, /* clearance or stiffness impossible for a bearing of that diameter */
  FG_LOAD_UNSAMPLED = 1 << 11,      /* the threshold lies in an unsampled stretch */
  FG_LOAD_SAME_SIDE = 1 << 12,      /* push and pull contact on one side of the gap */
  FG_LOAD_BRANCHES_APART = 1 << 13, /* loading and unloading contacts contradict each other */
  FG_LOAD_GAP_UNKNOWN = 1 << 14,    /* the data do not show whether there is a gap */
  FG_LOAD_OUTLIERS = 1 << 15,       /* isolated wrong readings, excluded */
  FG_LOAD_SATURATED = 1 << 16,      /* an instrument stood at the end of its range */
  FG_LOAD_LOOPS = 1 << 17,          /* loops within strokes, excluded */
  FG_LOAD_ONE_SENSE = 1 << 18,      /* strokes of one sense only */
  FG_LOAD_CONTRADICTION = FG_LOAD_SAME_SIDE | FG_LOAD_BRANCHES_APART,
};

typedef struct fg_load_flag {
  unsigned flag;
  const char *name, *plain;
} fg_load_flag;
const fg_load_flag *fg_load_flags(void); /* ends with a row whose name is NULL */

/* Point of the stiffness profile. */
typedef struct fg_load_point {
  double x_mm, force_n, stiffness_n_mm, u_stiffness_n_mm;
} fg_load_point;

enum { FG_LOAD_POINTS = 61 }; /* of each side */

typedef struct fg_load_profile {
  fg_load_point point[FG_LOAD_POINTS];
  size_t count;
} fg_load_profile;

enum { FG_LOAD_PULL, FG_LOAD_PUSH, FG_LOAD_SIDES };

typedef struct fg_load_sample {
  double x_mm, force_n;
} fg_load_sample;

/* H = (a + b |M|) ...; NaN where unknown. */
typedef struct fg_load_friction {
  double a_n, b, way_mm;
  double u_a_n, u_b;
} fg_load_friction;

typedef struct fg_load_direction {
  size_t bearing; /* fg_load_test.bearings[] */
  double azimuth_deg;
  char pad[64]; /* "" without such a column */
  unsigned flags;
  size_t first, count; /* of fg_load_test.samples[] */
  size_t strokes, cycles;
  double travel_mm, force_low_n, force_high_n;
  double noise_n, noise_mm;           /* sd of the columns; the displacement's with its step */
  double step_mm;                     /* rounding step of the displacement; 0: none visible */
  fg_load_value clearance, unloading; /* mm */
  fg_load_value gap;                  /* free travel, mm; NaN: unknown, or not shown */
  double zero_n;                      /* load cell's reading in the gap; NaN: unknown */
  double push_mm, pull_mm;            /* displacements at zero + T and zero - T */
  double drift_um_cycle;
  fg_load_value stiffness; /* N/mm, largest up to just before the turn */
  double stiffness_at_mm;
  fg_load_value area;                         /* N mm */
  fg_load_value secant;                       /* N/mm, of the loops' ends */
  fg_load_value loss, loss_secant, loss_foil; /* of the test with K or secant; of the foils alone */
  fg_load_friction friction;
  fg_load_profile profile[FG_LOAD_SIDES];
  fg_load_value predicted;  /* predicted from the lot, mm; NaN: no prediction */
  fg_load_value difference; /* gap - predicted */
  int predicted_pad; /* from 1: pad of the place that is touched first on both sides; 0: none */
} fg_load_direction;

enum { FG_LOAD_ORDER_MAX = 4 }; /* orders of the clearance over the azimuths: 2, 4 */

/* Reasons why an axis of the smallest clearance is not named. */
typedef enum fg_load_axis {
  FG_LOAD_AXIS_KNOWN,
  FG_LOAD_AXIS_FEW,    /* fewer than three axes were measured */
  FG_LOAD_AXIS_ROUND,  /* none is significant */
  FG_LOAD_AXIS_RIVALS, /* two minima closer than their uncertainty */
} fg_load_axis;
const char *fg_load_axis_words(fg_load_axis axis); /* NULL: known */

/* Faults of a break-away test, and reservations about its result. */
enum {
  FG_BREAK_TOO_FEW = 1 << 0,       /* too few pulls, or one weight */
  FG_BREAK_CURVED = 1 << 1,        /* not a straight line */
  FG_BREAK_UNCHECKED = 1 << 2,     /* linearity unknown */
  FG_BREAK_SLOPE = 1 << 3,         /* the slope is unknown */
  FG_BREAK_BELOW_ZERO = 1 << 4,    /* less friction than the rig's */
  FG_BREAK_RIG_NOT_GIVEN = 1 << 5, /* the rig's friction counts as preload */
  FG_BREAK_NONE_SHOWN = 1 << 6,    /* the preload lies within U of none */
  FG_BREAK_GAP = 1 << 7,           /* a preload although the load test has a clearance */
  FG_BREAK_SUSPECTED = 1 << 8,     /* possibly not a straight line */
  FG_BREAK_WEIGHTS = 1 << 9,       /* the weights' means scatter more than their pulls explain */
};
const fg_load_flag *fg_break_away_flags(void); /* ends with a row whose name is NULL */

/* One pull of a break-away test. */
typedef struct fg_break_away_pull {
  size_t bearing;
  double weight_n, friction_n; /* at the rotor's surface, the rig's friction included */
} fg_break_away_pull;

/* F over W of a bearing. NaN where unknown. */
typedef struct fg_break_away {
  size_t pulls, weights; /* 0: no such test */
  unsigned flags;
  double weight_low_n, weight_high_n;
  fg_load_value friction;    /* mu */
  fg_load_value intercept_n; /* F without a weight, less the rig's: mu P */
  double rig_n;              /* at the rotor's surface; NaN: not given */
  double residual_n;         /* sd about the line */
  double p_curved;           /* p-value of a straight line; NaN: too few pulls */
} fg_break_away;

typedef struct fg_load_bearing {
  char name[128];
  size_t directions, measured;
  double min_mm, max_mm, mean_mm, u_mean_mm, min_measured_at_deg, max_measured_at_deg;
  fg_load_value min, max; /* of the directions; mm */
  bool harmonic[FG_LOAD_ORDER_MAX + 1];
  double cosine_mm[FG_LOAD_ORDER_MAX + 1], sine_mm[FG_LOAD_ORDER_MAX + 1];
  double amplitude_mm[FG_LOAD_ORDER_MAX + 1], u_amplitude_mm[FG_LOAD_ORDER_MAX + 1];
  double p_value; /* of equal clearances in all directions; NaN: too few */
  fg_load_axis axis;
  double min_at_deg, u_min_at_deg;   /* of the fitted curve, 0 to 180; NaN: see `axis` */
  double birge;                      /* ratio of observed to expected scatter of the cycles */
  fg_load_value stiffness;           /* mean over the directions */
  double noise_n, noise_mm, step_mm; /* of the directions: means, and the largest step */
  fg_load_value hysteresis_n;        /* a of the directions' mean */
  double slope, u_slope;             /* b */
  fg_break_away break_away;
  fg_load_value preload_n, preload_kpa; /* of the break-away test */
  size_t unknown_places; /* places of the lot's bearing without a measured foil; predicted without
                            them */
  bool in_lot;
} fg_load_bearing;

typedef struct fg_load_file {
  char *path, sha256[65], *not_read; /* unused columns; NULL: none */
} fg_load_file;

typedef struct fg_load_test {
  fg_load_options options;
  fg_load_file *files;
  size_t file_count;
  fg_load_bearing *bearings;
  size_t bearing_count, bearing_capacity;
  fg_load_direction *directions; /* by bearing, then azimuth */
  size_t direction_count, direction_capacity;
  fg_load_sample *samples; /* of each direction contiguous, in order of time */
  size_t sample_count, sample_capacity;
  fg_break_away_pull *pulls;
  size_t pull_count, pull_capacity;
  char lot_sha256[65];
} fg_load_test;

/* FG_ERR_DATA names file, row and line: a missing column, a missing or unknown unit, a missing
 * number, times that do not increase. Never FG_ERR_NOT_MEASURED: a direction that cannot be
 * measured has a flag. `count` may be 0 where there are break-away tests. A break-away test without
 * a bearing's name belongs to the only bearing of the tests, else to one named like its file. Free
 * with fg_load_test_free. */
fg_status fg_load_test_measure(fg_context *ctx, const fg_load_options *options,
                               const fg_load_source *sources, size_t count, fg_load_test *test);
void fg_load_test_free(fg_load_test *test);

#ifdef __cplusplus
}
#endif
#endif
