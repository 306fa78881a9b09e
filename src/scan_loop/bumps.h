/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` of the loop on scans: the measured bumps, corrected for the effects found on the
 * rows, against the declared springback model. The model has one radius on all bumps of a foil, and
 * constant arc length (thesis eq 5.6 and 5.7). With a declared forming, it is the radius that the
 * forming predicts of each bump beside one level, and the predicted arc length.
 *
 * Radius and angle are tested. The height follows from them and the overall circle and is no
 * independent evidence, so only its errors before and after are predicted.
 *
 * With fewer than FG_SCAN_LOOP_BUMP_FOILS foils the bumps are the independent units, beside a level
 * of each foil: claims are then valid for these foils. With more, the foils are the units, as in a
 * table of a lot.
 *
 * A bump that is raised with its flanks leaves no residual on the rows, because every bump has a
 * circle of its own. It changes a dimension and shows here: bumps that deviate by their number, or
 * with a cycle over it, are the unattributed curve (`bump.index`). */
#ifndef FG_SCAN_LOOP_BUMPS_H
#define FG_SCAN_LOOP_BUMPS_H

#include "foilgauge/forming.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "foilgauge/measure.h"

enum {
  FG_SCAN_LOOP_BUMP_FOILS = 8,
  FG_SCAN_LOOP_BUMP_ROWS = 5,   /* fewer bumps are not tested */
  FG_SCAN_LOOP_BUMP_RADIUS = 0, /* responses */
  FG_SCAN_LOOP_BUMP_ANGLE = 1,
  FG_SCAN_LOOP_BUMP_RESPONSES = 2,
  FG_SCAN_LOOP_BUMP_EFFECTS = FG_LOOP_BUMP_KINDS - 1,
};

/* Bump of a part, averaged over the part's scans. `uncertainty`: error common to all bumps (of
 * measurement, and of undecided effects of the rows). */
typedef struct fg_scan_loop_bump {
  size_t part;
  int number;
  bool held_out;
  double overall_mm, height_mm;
  double value[FG_SCAN_LOOP_BUMP_RESPONSES],
      uncertainty[FG_SCAN_LOOP_BUMP_RESPONSES]; /* mm, degrees */
  double declared_mm;                           /* radius beside the level; 0: a level alone */
  double declared_arc;                          /* radius times angle, mm degrees */
} fg_scan_loop_bump;

/* Errors about the declared model, without and with the effects found; NaN where there are none. */
typedef struct fg_scan_loop_bump_error {
  double rms[2], held_out_rms[2];
} fg_scan_loop_bump_error;

typedef struct fg_scan_loop_bump_level {
  bool judged; /* `problem` and `result` are set */
  fg_loop_table_problem problem;
  fg_loop_result result; /* with the accepted claims; p-values over both responses */
  fg_loop_claim dropped[FG_LOOP_CLAIMS];
  size_t drops;
  double min;  /* smallest amplitude that exceeds the common uncertainty, the response's unit */
  double base; /* mean of response minus effects, over rows that are not held out */
  double level, u_level; /* mean of response minus declared value; NaN: no level is declared */
  fg_scan_loop_bump_error error;
} fg_scan_loop_bump_level;

typedef struct fg_scan_loop_bumps {
  fg_loop_effect
      effect[FG_SCAN_LOOP_BUMP_EFFECTS + 1]; /* effects searched; claims point here: do not move */
  fg_scan_loop_bump *bump;                   /* in order of part and number */
  size_t count, parts;
  bool lip;                             /* bump numbers count from a lip */
  const fg_forming_prediction *forming; /* NULL: the design's springback is declared */
  fg_scan_loop_bump_level level[FG_SCAN_LOOP_BUMP_RESPONSES];
  fg_scan_loop_bump_error height;
  char **note;
  size_t notes, note_capacity;
} fg_scan_loop_bumps;

typedef struct fg_scan_loop_bump_response {
  const char *name, *words, *unit;
  const char *model, *forming_model; /* names of the declared model and of the forming's */
  double scale;                      /* from the response's unit to `unit` */
} fg_scan_loop_bump_response;
extern const fg_scan_loop_bump_response fg_scan_loop_bump_responses[FG_SCAN_LOOP_BUMP_RESPONSES];

/* All foils of all scans. `open`: the rows have several explanations, so the bumps' corrections are
 * uncertain. */
typedef struct fg_scan_loop_bumps_request {
  const fg_measurement *before, *after;
  const bool *hold_out;
  size_t scan_count;
  bool same_foil, open;
  bool bent; /* the bumps are not circles: their deviation from one has been found */
  const fg_forming_prediction *forming; /* NULL: the design's springback is declared */
  uint64_t seed;
} fg_scan_loop_bumps_request;

/* FG_ERR_DATA when the forming does not predict a measured bump. */
fg_status fg_scan_loop_bumps_check_forming(fg_context *ctx, const fg_forming_prediction *forming,
                                           const fg_measurement *measured, size_t scan_count);
/* Fills the declared values of every bump. */
fg_status fg_scan_loop_bumps_declare(fg_context *ctx, const fg_design *design,
                                     fg_scan_loop_bumps *bumps);
/* Returns the declared model's prediction of a response, without the level and without the angle of
 * the design's arc length. */
double fg_scan_loop_bumps_offset(const fg_design *design, const fg_scan_loop_bump *bump,
                                 size_t response);
/* Finds the difference of the measured level from the declared one, and its uncertainty. */
void fg_scan_loop_bumps_find_level(fg_scan_loop_bumps *bumps, size_t response);

/* Fills `bump`: one row per bump of a part. Held-out scans of a part that others show too add
 * nothing. */
fg_status fg_scan_loop_bumps_collect(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                     fg_scan_loop_bumps *bumps);

/* Foils that are too small, or have no lip, are a note, not an error. */
fg_status fg_scan_loop_bumps_run(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                 fg_scan_loop_bumps *bumps);
void fg_scan_loop_bumps_free(fg_scan_loop_bumps *bumps);

/* Adds a note for the reader. */
fg_status fg_scan_loop_bumps_note(fg_context *ctx, fg_scan_loop_bumps *bumps, const char *format,
                                  ...) __attribute__((format(printf, 3, 4)));

/* Visits every effect that is not claimed, of each response, with its report: for JSON, page and
 * text alike. None without bumps. */
typedef void fg_scan_loop_bumps_visitor(size_t response, const fg_loop_rejected *one, void *user);
void fg_scan_loop_bumps_rejected(const fg_scan_loop_bumps *bumps, fg_scan_loop_bumps_visitor *visit,
                                 void *user);

bool fg_scan_loop_bumps_claimed(const fg_scan_loop_bumps *bumps);
/* Returns the unattributed curve, and its response; NULL: none. */
const fg_loop_curve *fg_scan_loop_bumps_curve(const fg_scan_loop_bumps *bumps, size_t *response);
/* Computes the p-value of a claim of one response among the rows that are not held out, for units
 * too few for sign flips. */
fg_status fg_scan_loop_bumps_null_p(fg_context *ctx, const fg_loop_problem *problem,
                                    const fg_loop_claim *claim, uint64_t seed, double *p_value);
/* Finds bumps that deviate by their number, or a cycle over it, beside the effects found; they
 * become the response's curve and a note, unless it has a curve already. */
fg_status fg_scan_loop_bumps_find_single(fg_context *ctx, fg_scan_loop_bumps *bumps,
                                         size_t response, uint64_t seed);
/* Reads the i-th parameter of a claim; false beyond the last. */
bool fg_scan_loop_bumps_parameter(const fg_scan_loop_bumps *bumps, size_t response,
                                  const fg_loop_claim *claim, size_t i, const char **name,
                                  double *value, double *u);

#endif
