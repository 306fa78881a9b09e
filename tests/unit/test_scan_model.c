/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model file of a scanner: a model that the loop writes is read again as it was, and an
 * impossible scanner is refused with the file, the member, its value and the values allowed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scan_loop/result.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"
#include "scan_loop/verdict.h"
#include "support/test.h"

enum { GRID = 41 };

static void add_effect(fg_effect_set *set, const char *id, double shape, double first_um,
                       double second_um) {
  const fg_effect *kind = fg_effect_find(id);
  fg_effect_found *effect = &set->effects[set->count++];
  assert_non_null(kind);
  *effect = (fg_effect_found){.kind = kind, .columns = kind->columns, .shapes = kind->shapes};
  effect->coefficient_um[0] = first_um;
  effect->u_coefficient_um[0] = fabs(first_um) / 300;
  if (kind->columns > 1) {
    effect->coefficient_um[1] = second_um;
    effect->u_coefficient_um[1] = fabs(second_um) / 170;
  }
  effect->shape[0] = shape;
  effect->u_shape[0] = kind->shapes ? fabs(shape) / 7000 : 0;
}

static void decide(fg_scan_loop *loop) {
  fg_context ctx = {0};
  if (fg_scan_loop_decide(&ctx, loop) != FG_OK) fail_msg("%s", ctx.message);
}

/* A loop that has found two ripples and two steps, and cannot tell a scale from a distortion. */
static fg_scan_loop *make_loop(void) {
  fg_scan_loop *loop = calloc(1, sizeof *loop);
  assert_non_null(loop);
  loop->options.scanner = "left desk";
  loop->before = calloc(1, sizeof *loop->before);
  loop->hold_out = calloc(1, sizeof *loop->hold_out);
  assert_non_null(loop->before);
  assert_non_null(loop->hold_out);
  loop->scan_count = 1;
  strcpy(loop->before[0].scan, "a.png");
  memset(loop->before[0].sha256, 'a', 64);
  loop->before[0].dpi[0] = loop->before[0].dpi[1] = 1200;
  loop->edge_fit.frame = (fg_field_frame){.centre_mm = {20.108333333333333, 20.1},
                                          .high_mm = {40.216666666666667, 40.2},
                                          .first_mm = {2.1 / 3, 1.7 / 3},
                                          .last_mm = {39 + 1.0 / 3, 38 + 2.0 / 3},
                                          .knots = FG_FIELD_COLUMNS};
  fg_effect_set *set = &loop->set, *other = &loop->tie[0];
  add_effect(set, "scan.scale_y", 0, 36.0 / 7, 0);
  add_effect(set, "scan.carriage_ripple", 3.1 / 3, 10.0 / 3, -5.0 / 7);
  add_effect(set, "scan.carriage_ripple", 7.7 / 3, 4.0 / 3, 8.0 / 7);
  add_effect(set, "scan.row_step", 41.0 / 3, -21.0 / 13, 0);
  add_effect(set, "scan.row_step", 77.0 / 3, 17.0 / 13, 0);
  *other = *set;
  other->count = 0;
  add_effect(other, "scan.optical_quadratic", 19.0 / 3, 25.0 / 7, 0);
  for (size_t e = 1; e < set->count; e++)
    other->effects[other->count++] = set->effects[e];
  loop->tie_count = 1;
  loop->tied = true;
  loop->explanations.count = 1;
  decide(loop);
  return loop;
}

static void free_loop(fg_scan_loop *loop) {
  fg_scan_result_free(&loop->result);
  free(loop->before);
  free(loop->hold_out);
  free(loop);
}

static char *write_text(const fg_scan_loop *loop) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  assert_non_null(out);
  if (fg_scan_loop_write_model(&ctx, loop, out) != FG_OK) fail_msg("%s", ctx.message);
  fclose(out);
  return text;
}

static void assert_same_fields(const fg_field_list *read, const fg_field_list *written) {
  assert_int_equal(read->count, written->count);
  for (int i = 0; i < GRID; i++)
    for (int k = 0; k < GRID; k++) {
      fg_point at = {45.0 * i / (GRID - 1) - 2, 45.0 * k / (GRID - 1) - 2};
      fg_point a = fg_field_at(read, at), b = fg_field_at(written, at);
      assert_near(a.x, b.x, 1e-12);
      assert_near(a.y, b.y, 1e-12);
    }
  for (size_t f = 0; f < read->count; f++) {
    const fg_field *a = &read->fields[f], *b = &written->fields[f];
    assert_string_equal(a->id, b->id);
    for (size_t c = 0; c < a->columns; c++)
      assert_near(a->u_amplitude_mm[c], b->u_amplitude_mm[c], 1e-15);
    for (size_t s = 0; s < a->shapes; s++)
      assert_near(a->u_shape[s], b->u_shape[s], 1e-15);
  }
}

static void a_written_scanner_model_reads_back_equal(void **state) {
  fg_context ctx = {0};
  fg_scanner_model *model = NULL;
  fg_field_list written;
  fg_scan_loop *loop = make_loop();
  char *text = write_text(loop);
  (void)state;
  if (fg_scanner_model_parse(&ctx, "written.json", text, &model) != FG_OK)
    fail_msg("%s", ctx.message);
  fg_effect_set_fields(&loop->edge_fit, &loop->set, &written);
  assert_same_fields(&model->fields, &written);
  assert_true(fg_scanner_model_is_tied(model));
  assert_int_equal(model->others, 1);
  fg_effect_set_fields(&loop->edge_fit, &loop->tie[0], &written);
  assert_same_fields(&model->other[0], &written);
  assert_string_equal(model->scanner, "left desk");
  fg_scanner_model_free(model);
  free(text);
  free_loop(loop);
}

/* A keystone moves the corners that no single diagonal passes. */
static void an_effect_is_told_by_its_half_range_over_the_plane(void **state) {
  fg_context ctx = {0};
  fg_scanner_model *model = NULL;
  fg_scanner_model_facts facts;
  fg_scan_loop *loop = make_loop();
  double low = INFINITY, high = -INFINITY;
  (void)state;
  loop->tied = false;
  loop->tie_count = loop->set.count = 0;
  add_effect(&loop->set, "scan.keystone", 0, 7, 0);
  decide(loop);
  char *text = write_text(loop);
  if (fg_scanner_model_parse(&ctx, "written.json", text, &model) != FG_OK)
    fail_msg("%s", ctx.message);
  const fg_field_frame *f = &model->fields.frame;
  for (int i = 0; i < 4; i++) {
    fg_point at = {i % 2 ? f->high_mm[0] : f->low_mm[0], i / 2 ? f->high_mm[1] : f->low_mm[1]};
    double x = fg_field_at(&model->fields, at).x;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  assert_true(low < 0 && high > 0);
  fg_scanner_model_describe(model, &facts);
  assert_near(facts.effect[0].half_range_um, 500 * (high - low), 1e-6);
  fg_scanner_model_free(model);
  free(text);
  free_loop(loop);
}

static bool writes_weights(fg_scan_loop *loop) {
  decide(loop);
  char *text = write_text(loop);
  bool has = strstr(text, "\"weights\"") != NULL;
  free(text);
  return has;
}

/* A tie of the foil and the scanner keeps its range; among causes of the scanner alone the likelier
 * one counts more. */
static void a_tie_of_part_and_scanner_has_no_probabilities(void **state) {
  fg_scan_loop *loop = make_loop();
  (void)state;
  loop->by_evidence = true;
  assert_true(writes_weights(loop));
  add_effect(&loop->tie[0], "part.ovality", 0, 9, 4);
  assert_false(writes_weights(loop));
  add_effect(&loop->set, "part.ovality", 0, 9, 4);
  assert_true(writes_weights(loop));
  loop->tie[0].count--;
  assert_false(writes_weights(loop));
  loop->edge_fit.discs = true;
  assert_true(writes_weights(loop));
  free_loop(loop);
}

/* A model that its own reader would refuse is not written. */
static void unreadable_scanner_models_are_not_written(void **state) {
  fg_context ctx = {0};
  fg_scan_loop *loop = make_loop();
  FILE *out = fopen("/dev/null", "w");
  (void)state;
  assert_non_null(out);
  loop->set.effects[1].coefficient_um[0] = 5000;
  decide(loop);
  assert_status(&ctx, fg_scan_loop_write_model(&ctx, loop, out), FG_ERR_DATA);
  assert_has(ctx.message, "scan.carriage_ripple");
  fclose(out);
  free_loop(loop);
}

#define HEAD  "{\"schema\":\"foilgauge/scan-model/1\",\"scanner\":null,\"tied\":false,"
#define PLACE "\"dpi\":[1200,1200],\"region_mm\":[0,0,40,40],"
#define SCALE(amplitude, u)                                                                        \
  "{\"id\":\"scan.scale_y\",\"amplitude_mm\":[" amplitude "],\"u_amplitude_mm\":[" u               \
  "],\"shape\":[],\"u_shape\":[]}"
#define RIPPLE(period, u)                                                                          \
  "{\"id\":\"scan.carriage_ripple\",\"amplitude_mm\":[0.003,0.001],\"u_amplitude_mm\":[0,0],"      \
  "\"shape\":[" period "],\"u_shape\":[" u "]}"
#define LENS(amplitude, centre)                                                                    \
  "{\"id\":\"scan.optical_quadratic\",\"amplitude_mm\":[" amplitude "],\"u_amplitude_mm\":[0],"    \
  "\"shape\":[" centre "],\"u_shape\":[0.1]}"
#define FIELDS(list) "\"fields\":[" list "],\"alternatives\":[]}"
#define GOOD         SCALE("0.036", "1e-6")
#define TIED         "\"fields\":[" GOOD "],\"alternatives\":[[]]}"

static void impossible_scanner_models_are_refused(void **state) {
  static const struct {
    const char *json, *member, *value, *allowed;
  } table[] = {
      {HEAD PLACE FIELDS(SCALE("0.036", "-1e-6")), "`fields[0].u_amplitude_mm[0]`", "-1e-06",
       "0 to 1"},
      {HEAD PLACE FIELDS(SCALE("0.036", "1e200")), "`fields[0].u_amplitude_mm[0]`", "1e+200",
       "0 to 1"},
      {HEAD PLACE FIELDS(SCALE("0.036", "1e999")), "`fields[0].u_amplitude_mm[0]`", "inf",
       "0 to 1"},
      {HEAD PLACE FIELDS(SCALE("0.036", "null")), "`fields[0].u_amplitude_mm[0]`", "null",
       "0 to 1"},
      {HEAD PLACE FIELDS(SCALE("5", "1e-6")), "`fields[0].amplitude_mm[0]`", "5", "-1 to 1"},
      {HEAD PLACE FIELDS(SCALE("-5", "1e-6")), "`fields[0].amplitude_mm[0]`", "-5", "-1 to 1"},
      {HEAD PLACE FIELDS(SCALE("\"0.1\"", "0")), "`fields[0].amplitude_mm[0]`", "text", "a number"},
      {HEAD PLACE FIELDS(SCALE("0.1,0.1", "0")), "`fields[0].amplitude_mm`", "2 numbers", "1"},
      {HEAD PLACE FIELDS(GOOD "," RIPPLE("0", "0.1")), "`fields[1].shape[0]`", "0", "0.01 to"},
      {HEAD PLACE FIELDS(GOOD "," RIPPLE("-3", "0.1")), "`fields[1].shape[0]`", "-3", "0.01 to"},
      {HEAD PLACE FIELDS(RIPPLE("3", "-0.1")), "`fields[0].u_shape[0]`", "-0.1", "0 to"},
      {HEAD PLACE FIELDS(RIPPLE("3", "1e9")), "`fields[0].u_shape[0]`", "1e+09", "0 to"},
      {HEAD PLACE FIELDS(LENS("0.003", "1e6")), "`fields[0].shape[0]`", "1e+06", "-400 to 440"},
      {HEAD PLACE FIELDS(LENS("1", "0")), "`fields`", "bends", "tenth"},
      {HEAD PLACE "\"fields\":[" GOOD "],\"alternatives\":[[],[" SCALE("0.1", "-1") "]]}",
       "`alternatives[1][0].u_amplitude_mm[0]`", "-1", "0 to 1"},
      {HEAD PLACE "\"fields\":[" GOOD "],\"alternatives\":[7]}", "`alternatives[0]`", "", "array"},
      {HEAD PLACE "\"weights\":[0.5]," TIED, "`weights`", "1 alternatives", "array"},
      {HEAD PLACE "\"weights\":[1.5,-0.5]," TIED, "`weights[0]`", "1.5", "0 to 1"},
      {HEAD PLACE "\"weights\":[0.5,null]," TIED, "`weights[1]`", "nan", "0 to 1"},
      {HEAD PLACE "\"weights\":[0.5,0.4]," TIED, "`weights`", "0.9", "must be 1"},
      {HEAD PLACE FIELDS(GOOD "," GOOD "," GOOD "," GOOD "," GOOD "," GOOD "," GOOD "," GOOD
                              "," GOOD),
       "`fields`", "9", "8"},
      {HEAD "\"dpi\":[1200,-1],\"region_mm\":[0,0,40,40]," FIELDS(GOOD), "`dpi[1]`", "-1", "1 to"},
      {HEAD "\"dpi\":[1200],\"region_mm\":[0,0,40,40]," FIELDS(GOOD), "`dpi`", "1 number", "2"},
      {HEAD "\"dpi\":[1200,1200],\"region_mm\":[0,0,40,1e9]," FIELDS(GOOD), "`region_mm[3]`",
       "1e+09", "-2000 to 2000"},
      {HEAD "\"dpi\":[1200,1200],\"region_mm\":[0,0,40,0.1]," FIELDS(GOOD), "`region_mm`", "0.1",
       "1 to 2000"},
      {HEAD "\"dpi\":[1200,1200],\"region_mm\":[40,0,0,40]," FIELDS(GOOD), "`region_mm`", "-40",
       "1 to 2000"},
      {HEAD PLACE "\"curve_mm\":[0,0,4000,40]," FIELDS(GOOD), "`curve_mm[2]`", "4000",
       "-2000 to 2000"},
      {HEAD PLACE "\"curve_mm\":[9,0,8,40]," FIELDS(GOOD), "`curve_mm`", "-1", "1 to 2000"},
      {HEAD PLACE "\"curve_knots\":4.5," FIELDS(GOOD), "`curve_knots`", "4.5", "4 to 24"},
      {"{\"schema\":\"foilgauge/scan-model/1\",\"tied\":1," PLACE FIELDS(GOOD), "`tied`", "",
       "true or false"},
      {HEAD PLACE "\"curve_knots\":25," FIELDS(GOOD), "`curve_knots`", "25", "4 to 24"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    in_row("table[%zu]", i);
    fg_context ctx = {0};
    fg_scanner_model *model = NULL;
    fg_status status = fg_scanner_model_parse(&ctx, "bad.json", table[i].json, &model);
    if (status != FG_ERR_DATA) fail_msg("row %zu is taken: %s", i, table[i].json);
    assert_null(model);
    const char *wanted[] = {"bad.json: ", table[i].member, table[i].value, table[i].allowed};
    for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++)
      if (!strstr(ctx.message, wanted[k]))
        fail_msg("row %zu: '%s' does not say '%s'", i, ctx.message, wanted[k]);
  }
}

static void possible_scanner_models_are_accepted(void **state) {
  static const char *const table[] = {
      HEAD PLACE FIELDS(GOOD),
      HEAD PLACE FIELDS(""),
      HEAD PLACE FIELDS(GOOD "," GOOD "," RIPPLE("3", "null") "," RIPPLE("3", "0.01")),
      HEAD PLACE FIELDS(LENS("0.003", "-30")),
      HEAD PLACE "\"curve_mm\":[-0.5,0,40.5,40],\"curve_knots\":9," FIELDS(SCALE("1", "1")),
  };
  (void)state;
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    in_row("table[%zu]", i);
    fg_context ctx = {0};
    fg_scanner_model *model = NULL;
    if (fg_scanner_model_parse(&ctx, "good.json", table[i], &model) != FG_OK)
      fail_msg("row %zu: %s", i, ctx.message);
    fg_scanner_model_free(model);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_written_scanner_model_reads_back_equal),
      cmocka_unit_test(an_effect_is_told_by_its_half_range_over_the_plane),
      cmocka_unit_test(a_tie_of_part_and_scanner_has_no_probabilities),
      cmocka_unit_test(unreadable_scanner_models_are_not_written),
      cmocka_unit_test(impossible_scanner_models_are_refused),
      cmocka_unit_test(possible_scanner_models_are_accepted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
