/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Die compensation: the next die from what lots show of the springback, the lot that comes of it,
 * and whether that was right.
 *
 * SPRINGBACK is the logarithm of formed over die, of four quantities: bump radius and bump arc
 * length by the bump's number, overall radius and pitch by the foil. Of set l (the foils of one
 * lot from one die), foil f and bump b:
 *
 *   ln(formed / die) = m + g ln(die / target) + bump_b + set_l + foil_f + e
 *
 * m is common to all; g is the dependence on the die's own size (curvature lost at release does
 * not depend on the radius: then g = m; a constant ratio has g = 0); bump_b deviates by the bump's
 * number; set_l is of the set, independent or as a drift from set to set; foil_f and e scatter.
 * The sizes of bump, set, foil and e are unknown: the posterior is a mixture over a grid of them
 * (empirical Bayes would call few lots too certain). Sets enter by sufficient statistics, so that
 * an earlier posterior with one lot more is the posterior of all lots.
 *
 * THE DIE lands the expected mean on the target: ln die = (ln target - m - bump) / (1 + g), of
 * radius, arc length, overall radius (a mandrel's) and pitch; angle and height follow. Lengths are
 * of the design's datum line.
 */
#ifndef FOILGAUGE_COMPENSATION_H
#define FOILGAUGE_COMPENSATION_H

#include <stdio.h>

#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FG_COMPENSATION_BUMPS = 64, /* maximum of a foil */
  FG_COMPENSATION_SETS = 24,  /* maximum over all lots */
  FG_COMPENSATION_NOTES = 24,
  FG_COMPENSATION_SETTINGS = 28, /* of a heat treatment */
};

/* Quantities that springback changes, each by itself. */
typedef enum fg_formed {
  FG_FORMED_RADIUS,     /* of a bump */
  FG_FORMED_ARC_LENGTH, /* R alpha of a bump */
  FG_FORMED_OVERALL,    /* overall radius */
  FG_FORMED_PITCH,      /* angle from bump to bump */
  FG_FORMED
} fg_formed;

/* Dimensions of a die, or of a foil as it should be. */
typedef struct fg_die_bump_dimensions {
  int number;
  double radius_mm, u_radius_mm;
  double bump_angle_deg, u_bump_angle_deg;
  double height_mm, u_height_mm;
  double place_deg, u_place_deg; /* direction from O, from the middle of all bumps */
} fg_die_bump_dimensions;

typedef struct fg_die_dimensions {
  double overall_radius_mm, u_overall_radius_mm;
  double pitch_deg, u_pitch_deg;
  double fillet_radius_mm;
  fg_die_bump_dimensions bump[FG_COMPENSATION_BUMPS];
  size_t bumps;
} fg_die_dimensions;

/* Source of a set's die. */
typedef enum fg_die_origin {
  FG_DIE_AS_DESIGNED, /* nothing is known of it: the lot's design */
  FG_DIE_AS_MEASURED, /* a report of `foilgauge die` */
  FG_DIE_AS_CUT,      /* an earlier next die: as it was to be cut */
} fg_die_origin;

/* Springback of one place (bump; number 0: the whole foil) in a set. */
typedef struct fg_formed_place {
  int number;
  double foils;     /* with a value */
  double die;       /* mm, degrees of the pitch */
  double log_ratio; /* mean of ln(formed / die) */
} fg_formed_place;

/* Sufficient statistics of a quantity in a set: means by place, and the sums of squares of the
 * foils' levels and of the remainder about them. */
typedef struct fg_formed_data {
  fg_formed_place place[FG_COMPENSATION_BUMPS];
  size_t places;
  double level_squares, level_dof, rest_squares, rest_dof;
} fg_formed_data;

typedef struct fg_formed_set {
  char lot[128], die[64], folder[1024], date[16];
  char sha256[65], scans_sha256[65]; /* of results.jsonl; of the sums of its scans */
  fg_die_origin origin;
  size_t foils;
  fg_formed_data of[FG_FORMED];
} fg_formed_set;

/* The law of one quantity, in percent of the size: means of the posterior. */
typedef struct fg_formed_law {
  double springback_pct, u_springback_pct; /* of the target's size, mean over the bumps */
  double exponent, u_exponent;             /* g */
  double bump_sd_pct, set_sd_pct, foil_sd_pct, rest_sd_pct;
  double drift_probability; /* the sets drift, against: each set by itself */
} fg_formed_law;

/* The law as it is kept in reports, from which a later one goes on. */
typedef struct fg_springback_law {
  fg_formed_set set[FG_COMPENSATION_SETS]; /* in order, the latest last */
  size_t sets;
  fg_formed_law of[FG_FORMED];
} fg_springback_law;

/* A value of the next lot: its mean over `foils` foils, with its interval of 95 %. */
typedef struct fg_expected_value {
  double value, u;  /* of the process with the new die */
  double low, high; /* of the mean of the lot's foils */
  double sd;        /* of single foils about that mean */
} fg_expected_value;

typedef struct fg_expected_bump {
  int number;
  fg_expected_value radius_mm, bump_angle_deg, height_mm;
} fg_expected_bump;

typedef struct fg_expected_share {
  char quantity[48];
  double lower, upper; /* the tolerance */
  double share, low, high;
} fg_expected_share;

typedef struct fg_expected_lot {
  size_t foils;
  fg_expected_value overall_radius_mm, pitch_deg;
  fg_expected_bump bump[FG_COMPENSATION_BUMPS];
  size_t bumps;
  fg_expected_share tolerance[FG_TOLERANCES_MAX];
  size_t tolerances;
  double share, share_low, share_high; /* foils within all tolerances; NaN: there are none */
  double assembled, assembled_low, assembled_high; /* bearings; NaN: none drawn */
} fg_expected_lot;

typedef struct fg_compensation_lot {
  const char *folder;
  const char *die; /* report of its die; NULL: its recipe's, or as designed */
} fg_compensation_lot;

/* An experiment that tells how springback depends on the heat treatment. */
typedef struct fg_setting_request {
  const char *runs;     /* table of the runs; NULL: none */
  const char *response; /* springback error, percent: of the overall radius, or of bumps */
  const char *formula;
  const char *setting; /* of the lots: "temperature_C=650, duration_h=5" */
} fg_setting_request;

/* A heat treatment with the die that it asks for. */
typedef struct fg_setting_trade {
  char text[160];
  double first, second;  /* values of the first two factors; NaN: there is none */
  double share, u_share; /* springback over that of the lots' setting */
  double springback_pct; /* of the bump radius (of a plain strip: of its radius); NaN: not told */
  double u_next_pct;     /* of the mean of the next lot's foils, with what lots differ by */
  double radius_mm, overall_radius_mm; /* of the die, mean over its bumps */
} fg_setting_trade;

typedef struct fg_compensation_request {
  const char *target; /* design; NULL: that of the last lot */
  const char *prior;  /* earlier report, whose sets come first; NULL: none */
  const fg_compensation_lot *lots;
  size_t lot_count;
  bool common;          /* one radius and angle for all bumps */
  double step_um;       /* smallest step that the shop can cut; 0: any */
  double min_radius_mm; /* smallest bump radius that it can cut; 0: any */
  double max_move_pct;  /* largest step from the present die */
  size_t foils;         /* of the next lot; 0: as many as in the last */
  fg_setting_request experiment;
} fg_compensation_request;

#define FG_COMPENSATION_MAX_MOVE_PCT 15.0

typedef struct fg_next_die {
  char target_path[1024], target_sha256[65];
  fg_design target;
  fg_nominal nominal;
  double step_um, min_radius_mm, max_move_pct;
  bool common;
  fg_springback_law *law;         /* owned */
  fg_die_dimensions present, die; /* of the last set; to be cut */
  double step_share;              /* of the step that the last lot alone asks for, as taken */
  fg_expected_lot expected;
  char doe_path[1024], doe_sha256[65];                /* "": no experiment */
  char factor[2][64];                                 /* names of its first two factors */
  fg_setting_trade setting[FG_COMPENSATION_SETTINGS]; /* that of the lots first */
  size_t settings, chosen;                            /* chosen: of the smallest u_next_pct */
  char note[FG_COMPENSATION_NOTES][400];
  size_t notes;
  struct fg_formed_laws *laws; /* private; owned */
} fg_next_die;

/* FG_ERR_DATA: no lot, a lot without foils, a die or lot of another kind, datum or thickness, a
 * target that no die within the limits reaches. Free with fg_next_die_free. */
fg_status fg_next_die_find(fg_context *ctx, const fg_compensation_request *request,
                           fg_next_die *next);
void fg_next_die_free(fg_next_die *next);

/* "foilgauge/next_die/1" (reports/schema/next_die.schema.json); the table for a terminal; a page;
 * the profile as DXF (R12, mm: arcs on the layers CONCAVE, CONVEX and DATUM). */
fg_status fg_next_die_write_json(fg_context *ctx, const fg_next_die *next, FILE *out);
fg_status fg_next_die_write_table(fg_context *ctx, const fg_next_die *next, FILE *out);
fg_status fg_next_die_write_html(fg_context *ctx, const fg_next_die *next, FILE *out);
fg_status fg_next_die_write_dxf(fg_context *ctx, const fg_next_die *next, FILE *out);
/* The trace that a stylus of that radius should see of a half: x, z in mm. */
fg_status fg_next_die_write_trace(fg_context *ctx, const fg_next_die *next, bool convex,
                                  double tip_um, FILE *out);

/* ---- was it right? ---- */

/* A value of the lot against its prediction. */
typedef struct fg_expected_held {
  double expected, low, high, measured; /* low, high: 95 % of the mean of as many foils */
  bool inside;
} fg_expected_held;

typedef struct fg_expected_held_bump {
  int number;
  fg_expected_held radius_mm, bump_angle_deg, height_mm;
} fg_expected_held_bump;

/* One die and its lot: error of the bump radii (of a plain strip: of the overall radius) against
 * the target, percent. */
typedef struct fg_iteration {
  const char *lot; /* of the law */
  size_t foils;
  double mean_error_pct, rms_error_pct; /* of the bumps' means */
  double springback_pct;                /* mean of 100 ln(formed / die) */
} fg_iteration;

typedef struct fg_expected_check {
  char path[1024], sha256[65]; /* of the report that predicted */
  char folder[1024];
  fg_next_die next; /* the prediction, for as many foils as the lot has; its law as updated */
  size_t foils;
  fg_expected_held_bump bump[FG_COMPENSATION_BUMPS];
  size_t bumps;
  fg_expected_held overall_radius_mm, pitch_deg;
  size_t inside, of; /* values inside their intervals */
  double p_value;    /* that a lot of the predicted process is as far off, over all radii */
  fg_iteration iteration[FG_COMPENSATION_SETS]; /* the latest last */
  size_t iterations;
  fg_formed_law before[FG_FORMED];      /* the law that predicted */
  char loop_verdict[32], loop_name[96]; /* of the loop over the lots' springback; "": none */
  char loop_sentence[1600];
} fg_expected_check;

/* FG_ERR_DATA, FG_ERR_IO: the file is no prediction. */
fg_status fg_expected_check_file(fg_context *ctx, const char *path);

/* Holds a lot, measured and reported in `folder`, against the report of `die --target`, and
 * updates the law with it. FG_ERR_DATA: another report, another kind of foil, no foil. Free with
 * fg_expected_check_free. */
fg_status fg_expected_check_run(fg_context *ctx, const char *path, const char *folder,
                                fg_expected_check *check);
void fg_expected_check_free(fg_expected_check *check);

/* Writes expected.json ("foilgauge/expected/1") and expected.html into the lot's folder. */
fg_status fg_expected_check_write(fg_context *ctx, const fg_expected_check *check);
fg_status fg_expected_check_write_json(fg_context *ctx, const fg_expected_check *check, FILE *out);
/* Writes the outcome in a sentence. */
void fg_expected_check_sentence(const fg_expected_check *check, char *text, size_t size);

#ifdef __cplusplus
}
#endif
#endif
