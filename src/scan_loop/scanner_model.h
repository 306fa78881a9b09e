/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scanner's model in memory. */
#ifndef FG_SCAN_LOOP_SCANNER_MODEL_H
#define FG_SCAN_LOOP_SCANNER_MODEL_H

#include "effect_search/effect_search.h"
#include "field/field.h"
#include "foilgauge/scan_loop.h"
#include "scan_loop/benefit.h"
#include "scan_loop/scanner_model_tone.h"

enum { FG_MODEL_DATE = 32 };
/* Maximum number of amplitudes and shapes of all fields, and of a map's modes. */
enum {
  FG_MODEL_NUMBERS_MAX = FG_FIELDS_MAX * (FG_FIELD_COLUMNS + FG_FIELD_SHAPES) + FG_MAP_MODES_MAX
};

struct fg_scanner_model {
  char sha256[65]; /* of the file */
  char path[1024]; /* as given */
  char scanner[FG_SCANNER_NAME];
  char date[FG_MODEL_DATE]; /* of its newest scan; "": not stated */
  double dpi[2];
  size_t scans;           /* number of its scans; 0: not stated */
  size_t known_diameters; /* gauges among its scans */
  size_t known_grids;     /* scans of grids of known pitch; without either its scale is unknown */
  fg_artefact artefact;   /* with these gauges; no name: none stated */
  double temperature_c, u_temperature_k; /* of the plate, and so the scanner; NaN: not stated */
  bool tied;
  fg_model_tone tone;
  fg_field_list fields;
  fg_field_map map; /* owned; no knots: none */
  /* Corrections by the explanations tied with it. */
  fg_field_list other[FG_EXPLANATIONS_MAX];
  size_t others;
  /* Probabilities by evidence: of `fields`, then of every other one; 0: none are known. */
  double weight[FG_BENEFIT_EXPLANATIONS_MAX];
  size_t weights;
};

/* Returns the weight of the model's explanation, or of one tied with it; equal where none are
 * known. */
double fg_scanner_model_weight(const fg_scanner_model *model, size_t explanation);

/* A scan that a model was found on. */
typedef struct fg_scanner_model_input {
  const char *path, *sha256;
  bool hold_out;
} fg_scanner_model_input;

/* Writes the file; refuses a model that the reader would refuse. */
fg_status fg_scanner_model_write(fg_context *ctx, const fg_scanner_model *model,
                                 const fg_scanner_model_input *inputs, size_t count, FILE *out);

/* FG_ERR_DATA for a picture that spoils edges in a way that no model describes. */
fg_status fg_scanner_model_check_picture(fg_context *ctx, const fg_measurement *m);

/* Takes the temperature that a design states of the part. */
void fg_scanner_model_set_temperature(const fg_calibration *calibration, fg_scanner_model *model);

/* Makes a model of a loop's scanner effects; free with fg_scanner_model_free. */
fg_status fg_scanner_model_of(fg_context *ctx, const fg_scan_loop *loop, fg_scanner_model **model);

extern const fg_document fg_scanner_model_document;

/* Checks that numbers are plausible for a scanner: FG_ERR_DATA names the member, its value and the
 * allowed range. Models written and read pass the same check. `member` is that of the list:
 * "fields", "alternatives[2]". */
fg_status fg_scanner_model_check_place(fg_context *ctx, const double dpi[2],
                                       const fg_field_frame *frame);
fg_status fg_scanner_model_check_fields(fg_context *ctx, const char *member,
                                        const fg_field_list *list);

/* Returns how far each component of a displacement ranges, mm, over places × places of its region.
 */
fg_point fg_scanner_model_span(const fg_field_list *list, int places);

/* Displacements by a model, and their uncertainty. */
typedef struct fg_model_uncertainty {
  fg_measurement each[FG_BENEFIT_EXPLANATIONS_MAX]; /* owned: by the model, then by the explanations
                                                       tied with it */
  size_t count;
  const fg_scanner_model *model;
  double *step[FG_MODEL_NUMBERS_MAX]; /* owned: displacement of every value by the uncertainty of
                                         one of the model's numbers */
  size_t steps;
  fg_grid_moves grid_step[FG_MODEL_NUMBERS_MAX]; /* of a grid's lattice, by the same */
  fg_benefits benefits;
} fg_model_uncertainty;

fg_status fg_model_uncertainty_open(fg_context *ctx, const fg_scanner_model *model,
                                    const fg_measurement *m, unsigned threads,
                                    fg_model_uncertainty *uncertainty);
void fg_model_uncertainty_close(fg_model_uncertainty *uncertainty);

/* Adds to every u_ the uncertainties of the model's numbers, and the mean square difference of the
 * tied explanations from the reported value. */
fg_status fg_model_uncertainty_widen(fg_context *ctx, const fg_model_uncertainty *uncertainty,
                                     fg_measurement *kept);

#endif
