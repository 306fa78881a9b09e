/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The result of the loop on scans agrees with its reports: every number of the struct stands in the
 * JSON, and the JSON says nothing else. Small scans, made by formula: a ring that is tied, a clean
 * foil, a foil with a ripple. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/scan_loop.h"
#include "report/scan_loop/parts.h"
#include "scan_loop/state.h"
#include "support/odd_scan.h"
#include "support/test.h"
#include <cjson/cJSON.h>

enum { FOIL_BUMPS = 5 };

static fg_scan_loop *close_loop(const odd_input *in) {
  fg_context ctx = {0};
  fg_measurement measurements[ODD_SCANS] = {0};
  static const bool none[ODD_SCANS] = {false};
  const fg_scan_loop_options options = {.threads = 1, .seed = 1};
  fg_scan_loop *loop = NULL;
  odd_measure(in, measurements);
  if (fg_scan_loop_run_measured(&ctx, measurements, none, in->scans, &options, &loop) != FG_OK)
    fail_msg("%s", ctx.message);
  return loop;
}

static odd_input foil_input(void) {
  odd_input in = {.scans = 1};
  fg_design_default(&in.design);
  in.scan[0].foils = 1;
  in.scan[0].foil[0] = odd_plain_foil(FOIL_BUMPS);
  return in;
}

static odd_input ring_input(void) {
  odd_input in = {.scans = 1};
  fg_design_default(&in.design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &in.design), FG_OK);
  in.scan[0].discs = 1;
  in.scan[0].disc[0] = (odd_disc){
      .x_mm = 20, .y_mm = 20, .radius_mm = 15, .noise_um = 0.3, .stations = 2000, .seed = 3};
  return in;
}

static cJSON *written(const fg_scan_loop *loop) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_non_null(out);
  assert_ok(&ctx, fg_scan_loop_write_json(&ctx, loop, out));
  fclose(out);
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  free(text);
  return json;
}

static const cJSON *member(const cJSON *object, const char *name) {
  const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!found) fail_msg("no member %s", name);
  return found;
}

/* Ten digits are written. */
static void assert_number(const cJSON *object, const char *name, double value) {
  const cJSON *found = member(object, name);
  if (!isfinite(value))
    assert_true(cJSON_IsNull(found));
  else
    assert_near(found->valuedouble, value, 1e-9 * fabs(value) + 1e-300);
}

static void assert_text(const cJSON *object, const char *name, const char *value) {
  assert_string_equal(member(object, name)->valuestring, value);
}

static void assert_texts(const cJSON *array, const char *const *text, size_t count) {
  assert_int_equal(cJSON_GetArraySize(array), count);
  for (size_t i = 0; i < count; i++)
    assert_string_equal(cJSON_GetArrayItem(array, (int)i)->valuestring, text[i]);
}

static void assert_errors(const cJSON *side, const fg_scan_loop_error *error) {
  assert_number(side, "rms", error->rms);
  assert_number(side, "robust_sd", error->robust_sd);
  assert_number(side, "p95", error->p95);
  assert_number(side, "maximum", error->maximum);
  assert_number(side, "held_out_rms", error->held_out_rms);
}

static void assert_ratios(const cJSON *json, const fg_scan_result *result) {
  assert_number(json, "rms", result->after.rms / result->before.rms);
  assert_number(json, "held_out", result->after.held_out_rms / result->before.held_out_rms);
  assert_int_equal(member(json, "folds")->valueint, result->folds);
  assert_int_equal(result->folds > 0, result->held_out == FG_SCAN_HELD_OUT_FOLDS);
  assert_int_equal(!result->folds, cJSON_IsNull(member(json, "fold_of")));
  if (result->folds) assert_text(json, "fold_of", result->fold_of);
}

static void assert_noise(const cJSON *json, const fg_scan_noise *noise) {
  assert_text(json, "form", noise->model);
  assert_number(json, "sd", noise->sd_um);
  assert_number(json, "white_sd", noise->white_um);
  assert_number(json, "correlated_sd", noise->correlated_um);
  assert_number(json, "correlation", noise->correlation);
  assert_number(json, "range_mm", noise->range_mm);
  assert_number(json, "long_waves", noise->long_waves);
  assert_near(hypot(noise->white_um, noise->correlated_um), noise->sd_um, 1e-9 * noise->sd_um);
  assert_int_equal(noise->correlation > 0, noise->range_mm > 0);
  assert_int_equal(!noise->discs, !cJSON_HasObjectItem(json, "sd_of_discs"));
  for (size_t d = 0; d < noise->discs; d++)
    assert_true(noise->disc_um[d] >= noise->sd_um * (1 - 1e-9));
}

/* The page's words. */
static void assert_summary(const cJSON *json, const fg_scan_result *result) {
  fg_context ctx = {0};
  char *sentence = NULL;
  assert_ok(&ctx, fg_scan_loop_sentence(&ctx, result, &sentence));
  assert_true(strlen(sentence) > 0);
  assert_text(json, "summary", sentence);
  free(sentence);
}

static void assert_claim(const cJSON *json, const fg_scan_result *result,
                         const fg_scan_result_claim *claim) {
  assert_text(json, "id", claim->id);
  assert_text(json, "verdict", fg_loop_verdict_word(claim->verdict));
  assert_number(json, "amplitude", claim->amplitude_um);
  assert_number(json, "retained_share", claim->retained_share);
  const cJSON *parameters = member(json, "parameters"), *u = member(json, "uncertainty");
  assert_int_equal(cJSON_GetArraySize(parameters), claim->parameters);
  for (size_t i = 0; i < claim->parameters; i++) {
    assert_number(parameters, claim->parameter[i].name, claim->parameter[i].value);
    assert_number(u, claim->parameter[i].name, claim->parameter[i].u);
  }
  assert_int_equal(claim->verdict == FG_LOOP_TIED, !claim->sure);
  const char *names[FG_SCAN_RESULT_EXPLANATIONS];
  for (size_t k = 0; k < result->explanations; k++)
    names[k] = result->explanation[k].name;
  assert_texts(member(json, "alias_class"), names, claim->sure ? 0 : result->explanations);
}

static void assert_claims(const cJSON *json, const fg_scan_result *result) {
  const cJSON *claims = member(json, "claims"), *claim = claims->child;
  for (size_t i = 0; i < result->claims; i++) {
    if (result->claim[i].free) continue;
    assert_non_null(claim);
    assert_text(claim, "level", "points");
    assert_claim(claim, result, &result->claim[i]);
    claim = claim->next;
  }
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t m = 0; m < result->bumps.response[r].claims; m++, claim = claim->next) {
      assert_non_null(claim);
      assert_text(claim, "level", "bumps");
      assert_text(claim, "id", result->bumps.response[r].claim[m].id);
      assert_number(claim, "amplitude", result->bumps.response[r].claim[m].amplitude);
    }
  assert_null(claim);
}

static void assert_unclaimed(const cJSON *json, const fg_scan_result *result) {
  const cJSON *one = member(json, "rejected")->child;
  for (size_t i = 0; i < result->unclaimeds; i++) {
    const fg_scan_result_unclaimed *unclaimed = &result->unclaimed[i];
    if (unclaimed->verdict == FG_LOOP_TIED) continue;
    assert_non_null(one);
    assert_text(one, "id", unclaimed->id);
    assert_text(one, "verdict", fg_loop_verdict_word(unclaimed->verdict));
    assert_number(one, "smallest_amplitude", unclaimed->smallest_um);
    assert_number(one, "would_explain", unclaimed->would_explain);
    assert_number(one, "retained_share", unclaimed->retained_share);
    assert_int_equal(cJSON_HasObjectItem(one, "not_confirmed"), unclaimed->barred);
    one = one->next;
  }
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t k = 0; k < result->bumps.response[r].unclaimeds; k++, one = one->next) {
      assert_non_null(one);
      assert_text(one, "id", result->bumps.response[r].unclaimed[k].id);
      assert_number(one, "smallest_amplitude", result->bumps.response[r].unclaimed[k].smallest);
    }
  assert_null(one);
}

/* The rows that are drawn are those that the errors are of. */
static void assert_rows(const fg_scan_result *result) {
  for (int after = 0; after < 2; after++) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < result->rows; i++) {
      const fg_scan_result_row *row = &result->row[i];
      if (!(row->weight > 0)) continue;
      sum += row->weight * row->residual_um[after] * row->residual_um[after];
      weight += row->weight;
    }
    double rms = after ? result->after.rms : result->before.rms;
    assert_near(sqrt(sum / weight), rms, 1e-9 * rms);
  }
}

static void assert_same(const fg_scan_loop *loop) {
  const fg_scan_result *result = fg_scan_loop_result(loop);
  cJSON *json = written(loop);
  assert_text(json, "verdict", fg_loop_outcome_word(result->verdict));
  assert_summary(json, result);
  assert_number(json, "noise_floor", result->noise_floor_um);
  assert_noise(member(json, "noise"), &result->noise);
  assert_errors(member(json, "before"), &result->before);
  assert_errors(member(json, "after"), &result->after);
  assert_ratios(member(json, "error_ratio"), result);
  assert_claims(json, result);
  assert_unclaimed(json, result);
  assert_texts(member(json, "separating_measurement"), result->advice, result->advices);
  assert_texts(member(json, "notes"), result->note, result->notes);
  assert_int_equal(cJSON_IsNull(member(json, "unattributed")),
                   !result->curve && !result->bumps.curve);
  assert_int_equal(result->corrected, result->claims > 0);
  assert_rows(result);
  cJSON_Delete(json);
}

static const fg_scan_result_unclaimed *find_unclaimed(const fg_scan_result *result,
                                                      const char *id) {
  for (size_t i = 0; i < result->unclaimeds; i++)
    if (!strcmp(result->unclaimed[i].id, id)) return &result->unclaimed[i];
  return NULL;
}

/* In one ring an oval scanner and an oval ring are the same. */
static void a_ring_is_tied(void **state) {
  (void)state;
  odd_input in = ring_input();
  in.scan[0].scanner.scale = 0.001;
  fg_scan_loop *loop = close_loop(&in);
  const fg_scan_result *result = fg_scan_loop_result(loop);
  assert_same(loop);
  assert_true(result->discs && result->tied && !result->named);
  assert_true(result->explanations > 1);
  assert_int_equal(result->claims, 1);
  assert_int_equal(result->claim[0].verdict, FG_LOOP_TIED);
  assert_string_equal(result->explanation[0].name, result->claim[0].id);
  assert_string_equal(result->explanation[0].words, result->claim[0].words);
  assert_string_equal(result->common, "");
  assert_true(isnan(result->after.held_out_rms)); /* there is no other disc */
  for (size_t k = 1; k < result->explanations; k++) {
    const fg_scan_result_unclaimed *other = find_unclaimed(result, result->explanation[k].name);
    if (strchr(result->explanation[k].name, '+')) continue;
    assert_non_null(other);
    assert_int_equal(other->verdict, FG_LOOP_TIED);
  }
  assert_int_equal(result->advices, 1);
  assert_has(result->advice[0], "plate of several gauges");
  fg_scan_loop_free(loop);
}

static void a_clean_foil_holds_nothing_to_draw(void **state) {
  (void)state;
  odd_input in = foil_input();
  fg_scan_loop *loop = close_loop(&in);
  const fg_scan_result *result = fg_scan_loop_result(loop);
  assert_same(loop);
  assert_int_equal(result->verdict, FG_LOOP_CLEAN);
  assert_true(result->named && !result->tied && !result->corrected && !result->contradicted);
  assert_near(result->before.held_out_rms, result->before.rms, 0);
  assert_near(result->after.held_out_rms, result->before.rms, 0);
  assert_int_equal(result->held_out, FG_SCAN_HELD_OUT_NOTHING);
  assert_int_equal(result->claims + result->lines + result->grid.lines + result->advices, 0);
  assert_null(result->curve);
  assert_true(result->rows > 60 && result->views == 1 && result->view[0].bumps == FOIL_BUMPS);
  fg_scan_loop_free(loop);
}

/* JSON has a ratio, people read ppm; what the sentence needs stands beside each other. */
static void a_scale_is_told_in_ppm(void **state) {
  (void)state;
  odd_input in = foil_input();
  in.scan[0].scanner.scale = 0.002;
  fg_scan_loop *loop = close_loop(&in);
  const fg_scan_result *result = fg_scan_loop_result(loop);
  assert_same(loop);
  assert_true(result->claims > 0 && result->corrected);
  const fg_scan_result_parameter *p = &result->claim[0].parameter[0];
  assert_string_equal(p->name, "value");
  assert_string_equal(p->unit, "ppm");
  assert_near(fabs(p->value), 0.002, 0.0002);
  assert_near(p->told, 1e6 * p->value, 1e-6);
  assert_near(p->u_told, 1e6 * p->u, 1e-6);
  fg_scan_loop_free(loop);
}

/* The line that is drawn, the grid and the model are the claim's own numbers. */
static void drawn_ripple_equals_the_claimed_one(void **state) {
  (void)state;
  enum { RIPPLE_UM = 8, PERIOD_MM = 3 };
  odd_input in = foil_input();
  in.scan[0].scanner.ripple_um = RIPPLE_UM;
  in.scan[0].scanner.period_mm = PERIOD_MM;
  fg_scan_loop *loop = close_loop(&in);
  const fg_scan_result *result = fg_scan_loop_result(loop);
  assert_same(loop);
  assert_int_equal(result->verdict, FG_LOOP_EXPLAINED);
  const fg_scan_result_claim *claim = &result->claim[0];
  assert_true(claim->sure && !claim->shape);
  assert_int_equal(result->folds, FOIL_BUMPS);
  assert_true(result->after.held_out_rms < 0.1 * result->before.held_out_rms);
  assert_false(result->contradicted);
  assert_string_equal(claim->parameter[0].name, "amplitude_um");
  assert_near(claim->parameter[0].value, RIPPLE_UM, 0.3);
  double highest = 0;
  for (int i = 0; i < FG_SCAN_RESULT_SAMPLES; i++)
    highest = fmax(highest, fabs(result->line[0].um[i]));
  assert_true(result->line[0].glass && result->line[0].axis == 'y');
  assert_near(highest, claim->parameter[0].value, 0.02 * RIPPLE_UM);
  assert_near(1000 * result->grid.largest_mm, claim->parameter[0].value, 0.02 * RIPPLE_UM);
  assert_near(result->grid.period_mm, PERIOD_MM, 0.05);
  fg_scanner_model_facts facts;
  fg_scanner_model_describe(result->model, &facts);
  assert_int_equal(facts.effects, 1);
  assert_string_equal(facts.effect[0].id, claim->id);
  assert_near(facts.effect[0].parameter[0].value, claim->parameter[0].value, 1e-9);
  assert_near(facts.effect[0].parameter[0].u, claim->parameter[0].u, 1e-9);
  fg_scan_loop_free(loop);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_ring_is_tied),
      cmocka_unit_test(a_clean_foil_holds_nothing_to_draw),
      cmocka_unit_test(a_scale_is_told_in_ppm),
      cmocka_unit_test(drawn_ripple_equals_the_claimed_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
