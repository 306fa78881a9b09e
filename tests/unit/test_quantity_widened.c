/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that widen an uncertainty know every row of the quantities. */
#include <stdbool.h>
#include <sys/types.h>

#include <cjson/cJSON.h>

#include "foilgauge/bearing.h"
#include "foilgauge/report.h"
#include "foilgauge/scan_loop.h"
#include "quantity/quantity_rows.h"
#include "report/lot/characteristics.h"
#include "support/made_lot.h"
#include "support/measured_render.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

/* A bump that everything can be derived of, and nothing has been. */
static fg_bump bare_bump(const fg_bump *from) {
  fg_bump bump;
  memset(&bump, 0xff, sizeof bump); /* doubles that are no number */
  bump.number = from->number;
  bump.flags = 0;
  bump.centre_mm = from->centre_mm;
  bump.radius_mm = from->radius_mm;
  memcpy(bump.covariance, from->covariance, sizeof bump.covariance);
  return bump;
}

/* A row without its function would keep its old value; a bump that a loop corrected is uncertain by
 * (X, R, R0), and the u of everything that follows from them grows. */
static void a_bumps_rows_are_derived_and_widened(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  const fg_foil *foil = &measurement.foils[0];
  fg_thickness strip = fg_foil_thickness(&design, foil);
  double uncertainty[3][3] = {{4e-8, 0, 0}, {0, 9e-8, 0}, {0, 0, 1e-8}};
  fg_bump bump = bare_bump(&foil->bumps[2]);
  fg_bump_derive(&design, &nominal, &foil->overall, &strip, &bump);
  fg_bump wider = bump;
  fg_bump_widen(&design, &nominal, &foil->overall, uncertainty, &wider);
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    if (!fg_quantity_has_u(&rows[i])) continue;
    size_t width = fg_quantity_numbers(&rows[i], &bump, numbers);
    for (size_t k = 0; k < width; k++)
      if (!isfinite(numbers[k])) fail_msg("%s is not derived", rows[i].name);
    if (rows[i].kind == FG_QUANTITY_PAIR) continue; /* (X, R, R0) do not say where a bump lies */
    if (!(fg_quantity_uncertainty(&rows[i], &wider) > fg_quantity_uncertainty(&rows[i], &bump)))
      fail_msg("u of %s is not widened", rows[i].name);
  }
  synthetic_free(&measurement);
}

#define FIELD(id, amplitude, u)                                                                    \
  "{\"id\":\"" id "\",\"amplitude_mm\":[" amplitude "],\"u_amplitude_mm\":[" u                     \
  "],\"shape\":[],\"u_shape\":[]}"
/* A stretch of y and a shear, which moves x: nothing stays where it was. */
#define MODEL(u, other)                                                                            \
  "{\"schema\":\"foilgauge/scan-model/1\",\"scanner\":null,\"tied\":false,\"dpi\":[1200,1200],"    \
  "\"region_mm\":[0,0,60,60],\"fields\":[" FIELD("scan.scale_y", "0.036", u) "," FIELD(            \
      "scan.shear", "0.01", u) "],\"alternatives\":[" other "]}"
#define OTHER "[" FIELD("scan.shear", "0.02", "0") "]"

/* A foil and a disc, corrected by a model. */
static measured corrected_by(const char *json, fg_scanner_model **model) {
  enum { STATIONS = 360 };
  char spec[4096];
  small_foil(spec, sizeof spec, 3, "", "\"dpi\":1200");
  measured m = measure_render(spec, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  m.result.discs = calloc(1, sizeof *m.result.discs);
  m.result.disc_count = 1;
  m.result.discs[0] = synthetic_disc(1, 1.5);
  fg_disc *disc = &m.result.discs[0];
  disc->station_count = STATIONS;
  disc->stations = calloc(STATIONS, sizeof *disc->stations);
  for (int i = 0; i < STATIONS; i++) {
    double angle = 2 * synthetic_pi * i / STATIONS;
    double radius = 1.5 + 1e-3 * cos(2 * angle) + 2e-4 * sin(7 * angle);
    disc->stations[i] = (fg_disc_point){
        .at = {10 + radius * cos(angle), 12 + radius * sin(angle)}, .u = 1e-4, .used = true};
  }
  if (fg_scanner_model_parse(&m.ctx, "model.json", json, model) != FG_OK ||
      fg_scanner_model_apply(&m.ctx, *model, &m.result, 1, NULL) != FG_OK)
    fail_msg("%s", m.ctx.message);
  return m;
}

static void grows(fg_quantity_owner owner, const void *narrow, const void *wide) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double before[FG_QUANTITY_NUMBERS_MAX], after[FG_QUANTITY_NUMBERS_MAX];
    if (!fg_quantity_has_u(&rows[i])) continue;
    if (!fg_quantity_applies(owner, &rows[i], FG_FOIL_CLASSICAL)) continue;
    size_t width = fg_quantity_numbers(&rows[i], narrow, before);
    fg_quantity_numbers(&rows[i], wide, after);
    for (size_t k = fg_quantity_values(&rows[i]); k < width; k++) {
      if (!(after[k] > before[k]))
        fail_msg("u of %s does not grow: %g to %g", rows[i].name, before[k], after[k]);
      if (!rows[i].covariance) continue;
      size_t row = rows[i].covariance_row + k - fg_quantity_values(&rows[i]);
      double added = after[k] * after[k] - before[k] * before[k];
      size_t at = rows[i].covariance + (3 * row + row) * sizeof(double);
      double held[2];
      memcpy(&held[0], (const char *)narrow + at, sizeof *held);
      memcpy(&held[1], (const char *)wide + at, sizeof *held);
      if (!(fabs(held[1] - held[0] - added) <= 1e-6 * added))
        fail_msg("the covariance does not hold what u of %s grew by", rows[i].name);
    }
  }
}

static void grows_everywhere(const char *json) {
  fg_scanner_model *sure, *unsure;
  measured narrow = corrected_by(MODEL("0", ""), &sure), wide = corrected_by(json, &unsure);
  const fg_foil *a = &narrow.result.foils[0], *b = &wide.result.foils[0];
  grows(FG_QUANTITY_OF_FOIL, a, b);
  assert_int_equal(a->bump_count, 3);
  for (size_t i = 0; i < a->bump_count; i++)
    grows(FG_QUANTITY_OF_BUMP, &a->bumps[i], &b->bumps[i]);
  grows(FG_QUANTITY_OF_DISC, narrow.result.discs, wide.result.discs);
  fg_scanner_model_free(sure);
  fg_scanner_model_free(unsure);
  measured_free(&narrow);
  measured_free(&wide);
}

static void a_model_that_is_unsure_widens_every_row(void **state) {
  (void)state;
  grows_everywhere(MODEL("0.004", ""));
}

static void a_tie_widens_every_row(void **state) {
  (void)state;
  grows_everywhere(MODEL("0", OTHER));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bumps_rows_are_derived_and_widened),
      cmocka_unit_test(a_model_that_is_unsure_widens_every_row),
      cmocka_unit_test(a_tie_widens_every_row),
  };
  return cmocka_run_group_tests_name("widened quantities", tests, NULL, NULL);
}
