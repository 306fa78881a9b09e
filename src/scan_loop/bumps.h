/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` of the loop on scans: the measured bumps, after what was found on the points has
 * been taken out, against the declared springback model: one radius on all bumps of a foil, and
 * constant arc length (thesis eq 5.6 and 5.7); or, where a forming is declared, the radius that it
 * predicts of each bump beside one level, and the arc length that it predicts.
 *
 * Radius and angle are judged. The height follows from them and the overall circle (it is no third
 * witness), so it is only predicted: how far off before and after.
 *
 * With fewer than FG_SCAN_LOOP_BUMP_FOILS foils the bumps are the units that were drawn
 * independently, beside a level of each foil: what is found is then said of these foils. With more,
 * the foils are the units, as in a table of a lot.
 *
 * A bump that is raised with its flanks leaves nothing on the points: every bump has a circle of
 * its own. It is a dimension, and shows here: bumps that stand apart from the others by their
 * number, or with a cycle over it, are what no effect explains (`bump.index`). */
#ifndef FG_SCAN_LOOP_BUMPS_H
#define FG_SCAN_LOOP_BUMPS_H

#include "foilgauge/forming.h"
#include "foilgauge/loop.h"
#include "foilgauge/measure.h"

enum {
  FG_SCAN_LOOP_BUMP_FOILS = 8,
  FG_SCAN_LOOP_BUMP_ROWS = 5,   /* fewer bumps are not judged */
  FG_SCAN_LOOP_BUMP_RADIUS = 0, /* responses */
  FG_SCAN_LOOP_BUMP_ANGLE = 1,
  FG_SCAN_LOOP_BUMP_RESPONSES = 2,
  FG_SCAN_LOOP_BUMP_EFFECTS = FG_LOOP_BUMP_KINDS - 1,
};

/* One bump of one part; views of the same part are averaged. `doubt`: how far the value may be off
 * in all bumps together (its uncertainty, and what the points leave open). */
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

/* Errors about the declared model, without and with what was found; NaN where there are none. */
typedef struct fg_scan_loop_bump_error {
  double rms[2], held_out_rms[2];
} fg_scan_loop_bump_error;

typedef struct fg_scan_loop_bump_level {
  bool judged; /* `problem` and `result` are there */
  fg_loop_table_problem problem;
  fg_loop_result result; /* with the claims that stand; p-values over both responses */
  fg_loop_claim dropped[FG_LOOP_CLAIMS];
  size_t drops;
  double min;            /* smallest amplitude beyond doubt, the response's unit */
  double base;           /* mean of response minus effects, over rows that are not aside */
  double level, u_level; /* mean of response minus declared; NaN: none is declared beside one */
  fg_scan_loop_bump_error error;
} fg_scan_loop_bump_level;

typedef struct fg_scan_loop_bumps {
  fg_loop_effect
      effect[FG_SCAN_LOOP_BUMP_EFFECTS + 1]; /* looked for; claims point here: do not move */
  fg_scan_loop_bump *bump;                   /* in order of part and number */
  size_t count, parts;
  bool lip;                             /* bump numbers count from a lip */
  const fg_forming_prediction *forming; /* declared; NULL: the design's springback */
  fg_scan_loop_bump_level level[FG_SCAN_LOOP_BUMP_RESPONSES];
  fg_scan_loop_bump_error height;
  char **note;
  size_t notes, note_capacity;
} fg_scan_loop_bumps;

typedef struct fg_scan_loop_bump_response {
  const char *name, *words, *unit;
  const char *model, *forming_model; /* what it is held against */
  double scale;                      /* from the response's unit to `unit` */
} fg_scan_loop_bump_response;
extern const fg_scan_loop_bump_response fg_scan_loop_bump_responses[FG_SCAN_LOOP_BUMP_RESPONSES];

/* Every foil of every scan. `open`: the points did not settle on one explanation, so how far they
 * moved a bump is in doubt. */
typedef struct fg_scan_loop_bumps_request {
  const fg_measurement *before, *after;
  const bool *hold_out;
  size_t scan_count;
  bool same_foil, open;
  bool bent; /* the bumps are no circles: how they deviate from one has been found */
  const fg_forming_prediction *forming; /* NULL: the design's springback is declared */
  uint64_t seed;
} fg_scan_loop_bumps_request;

/* FG_ERR_DATA: a measured bump that the forming does not know. */
fg_status fg_scan_loop_bumps_check_forming(fg_context *ctx, const fg_forming_prediction *forming,
                                           const fg_measurement *measured, size_t scan_count);
/* Fills what is declared of every bump. */
fg_status fg_scan_loop_bumps_declare(fg_context *ctx, const fg_design *design,
                                     fg_scan_loop_bumps *bumps);
/* What the declared model says of a response besides the level, and besides the angle that the
 * design's arc length gives. */
double fg_scan_loop_bumps_offset(const fg_design *design, const fg_scan_loop_bump *bump,
                                 size_t response);
/* How far the measured level lies from the declared one, and by how far that may be off. */
void fg_scan_loop_bumps_find_level(fg_scan_loop_bumps *bumps, size_t response);

/* Fills `bump`: one row per bump of a part. A part's scans that were kept aside show nothing new of
 * it. */
fg_status fg_scan_loop_bumps_collect(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                     fg_scan_loop_bumps *bumps);

/* Foils that are too small, or have no lip, are no error but a note. */
fg_status fg_scan_loop_bumps_run(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                 fg_scan_loop_bumps *bumps);
void fg_scan_loop_bumps_free(fg_scan_loop_bumps *bumps);

/* Something the reader must know. */
fg_status fg_scan_loop_bumps_note(fg_context *ctx, fg_scan_loop_bumps *bumps, const char *format,
                                  ...) __attribute__((format(printf, 3, 4)));

/* Every effect that is not claimed, of each response, with what is said of it: for JSON, page and
 * text alike. None without bumps. */
typedef void fg_scan_loop_bumps_visitor(size_t response, const fg_loop_rejected *one, void *user);
void fg_scan_loop_bumps_rejected(const fg_scan_loop_bumps *bumps, fg_scan_loop_bumps_visitor *visit,
                                 void *user);

bool fg_scan_loop_bumps_claimed(const fg_scan_loop_bumps *bumps);
/* What no listed effect explains, and of which response; NULL: nothing. */
const fg_loop_curve *fg_scan_loop_bumps_curve(const fg_scan_loop_bumps *bumps, size_t *response);
/* The p-value of a claim of one response among the rows that are not aside, for units too few to
 * flip. */
fg_status fg_scan_loop_bumps_null_p(fg_context *ctx, const fg_loop_problem *problem,
                                    const fg_loop_claim *claim, uint64_t seed, double *p_value);
/* Bumps that stand apart from the others of a response by their number, or that follow a cycle over
 * it, become its curve and a note; beside what was found, and unless there is a curve. */
fg_status fg_scan_loop_bumps_find_single(fg_context *ctx, fg_scan_loop_bumps *bumps,
                                         size_t response, uint64_t seed);
/* The i-th parameter of a claim; false beyond the last. */
bool fg_scan_loop_bumps_parameter(const fg_scan_loop_bumps *bumps, size_t response,
                                  const fg_loop_claim *claim, size_t i, const char **name,
                                  double *value, double *u);

#endif
