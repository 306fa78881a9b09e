/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of effects: a row that the search, the reports' words, the renderer or the loop's
 * benchmark does not know fails here. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "effect_search/policy.h"
#include "effect_search/search.h"
#include "effect_search/width_search.h"
#include "evidence/options.h"
#include "evidence/search.h"
#include "foilgauge/render.h"
#include "support/brief.h"
#include "support/foil_rows.h"
#include "support/test.h"

#define AMPLITUDE_UM 20.0
#define NOISE_UM     0.03

/* Its leading column at the rows, and noise. */
static void put_effect(foil_rows *f, const fg_effect *effect) {
  const fg_field_frame *frame = &f->edge_fit.frame;
  const double amplitude_um = AMPLITUDE_UM;
  int axis = effect->axis;
  double shape[FG_FIELD_SHAPES] = {frame->centre_mm[axis]}, reach[FG_FIELD_SHAPES];
  if (effect->starts)
    fg_evidence_find_start(&f->edge_fit, effect, effect->starts * 2 / 3, shape, reach);
  if (effect->jumps && !effect->grid)
    shape[0] = 0.4 * frame->first_mm[axis] + 0.6 * frame->last_mm[axis];
  foil_rows_put_noise(f, NOISE_UM);
  assert_true(foil_rows_add_effect(f, effect, shape, &amplitude_um, 1) > 0);
}

static bool in_class(const fg_explanations *explanations, const fg_effect *effect) {
  for (size_t m = 0; m < explanations->count; m++)
    for (size_t e = 0; e < explanations->candidate_count; e++)
      if ((explanations->each[m].mask >> e & 1) &&
          fg_effect_same(explanations->candidates[e].kind, effect))
        return true;
  return false;
}

static bool is_candidate(const fg_explanations *explanations, const fg_effect *effect) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if (explanations->candidates[e].kind == effect) return true;
  return false;
}

/* Listed effects are found; curves need only be there, which any search shows. */
static void the_search_knows_every_row(void **state) {
  (void)state;
  foil_rows f;
  size_t count = 0;
  foil_rows_open(&f);
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    fg_context ctx = {0};
    fg_explanations explanations;
    if (effect->off_foils || fg_effect_is_free(effect) || effect->width || effect->by_evidence ||
        count++ % test_step(4))
      continue;
    put_effect(&f, effect);
    const fg_search_request request = {.policy = fg_search_policy_of(&f.edge_fit),
                                       .residual_um = f.residual_um,
                                       .jacobian = f.jacobian,
                                       .look = true};
    assert_ok(&ctx, fg_search_find(&ctx, &f.edge_fit, &request, &explanations));
    if (!explanations.right || !in_class(&explanations, effect))
      fail_msg("the search does not find %s", effect->id);
    for (const fg_effect *curve = fg_effect_first(); curve; curve = fg_effect_next(curve))
      if (fg_effect_is_free(curve) && !curve->by_evidence && !is_candidate(&explanations, curve))
        fail_msg("the search does not know %s", curve->id);
  }
  foil_rows_close(&f);
}

static bool leads(const fg_evidence_search *search, const fg_effect *effect) {
  const fg_evidence_model *best = &search->models[0];
  return best->parts == 1 && best->part[0]->effect && fg_effect_same(best->part[0]->effect, effect);
}

static void look_by_evidence(foil_rows *f, const fg_effect *effect, bool wanted) {
  fg_context ctx = {0};
  fg_evidence_search search;
  const fg_evidence_request request = {.prior = {1, 1}};
  assert_ok(&ctx, fg_evidence_search_open(&ctx, &f->edge_fit, &request, f->residual_um, f->jacobian,
                                          &search));
  assert_ok(&ctx, fg_evidence_search_run(&ctx, &search));
  if (leads(&search, effect) != wanted)
    fail_msg("%s %s", effect->id, wanted ? "does not lead" : "is found though it is left out");
  fg_evidence_search_close(&search);
}

static void evidence_knows_every_row_that_the_search_does_not(void **state) {
  (void)state;
  foil_rows f;
  size_t count = 0;
  foil_rows_open(&f);
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    if (!effect->by_evidence || effect->second || fg_effect_is_free(effect)) continue;
    if (count++ % test_step(8) % 3) continue; /* a third of them */
    put_effect(&f, effect);
    look_by_evidence(&f, effect, true);
    if (count > 1) continue;
    f.edge_fit.left_out = effect->id;
    look_by_evidence(&f, effect, false);
    f.edge_fit.left_out = NULL;
  }
  foil_rows_close(&f);
}

static void lists_of_effects_are_checked(void **state) {
  (void)state;
  fg_context ctx = {0};
  const fg_effect *yaw = fg_effect_find("scan.yaw");
  assert_ok(&ctx, fg_effect_check_list(&ctx, NULL));
  assert_ok(&ctx, fg_effect_check_list(&ctx, "part.dent,scan.yaw"));
  const char *wrong[] = {"",          "scan.yaw,",    "scan.ya",
                         "scan.yaws", "free.scan.xy", "scan.yaw, part.dent"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    assert_status(&ctx, fg_effect_check_list(&ctx, wrong[i]), FG_ERR_USAGE);
  assert_true(fg_effect_is_listed("part.dent,scan.yaw", yaw));
  assert_true(fg_effect_is_listed("scan.yaw,part.dent", yaw));
  assert_false(fg_effect_is_listed("scan.yaw2", yaw));
  assert_false(fg_effect_is_listed(NULL, yaw));
}

static void the_search_of_the_width_knows_every_row(void **state) {
  (void)state;
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    foil_rows f;
    fg_context ctx = {0};
    const fg_effect_set none = {.count = 0};
    fg_width_findings findings;
    uint64_t seed = 11;
    if (!effect->width) continue;
    foil_rows_open(&f);
    assert_int_equal(fg_effect_width_columns(&f.edge_fit, effect, NULL, f.columns), 1);
    for (size_t i = 0; i < f.edge_fit.row_count; i++)
      f.edge_fit.rows[i].half_width_mm +=
          (AMPLITUDE_UM * f.columns[i] + NOISE_UM * random_gaussian(&seed)) / 1000;
    assert_ok(&ctx, fg_search_width(&ctx, &f.edge_fit, &none, NULL, &findings));
    for (size_t e = 0; e < findings.count; e++) {
      if (findings.each[e].found != (findings.each[e].effect.kind == effect))
        fail_msg("the width with %s in it is taken wrongly", effect->id);
      if (findings.each[e].found)
        assert_float_equal(fg_effect_found_amplitude(&findings.each[e].effect), AMPLITUDE_UM, 0.1);
    }
    if (!findings.found) fail_msg("the search does not find %s", effect->id);
    foil_rows_close(&f);
  }
}

static void every_effect_row_is_complete(void **state) {
  (void)state;
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    if (!effect->words || !effect->equation) fail_msg("%s has no words", effect->id);
    if (!!effect->glass + !!effect->midline + !!effect->width != 1)
      fail_msg("%s moves nothing, or two things", effect->id);
    if (!effect->width != (effect->sought != FG_EFFECT_OF_WIDTH))
      fail_msg("%s: where is it sought?", effect->id);
    if (!effect->says[0] != !effect->says[1])
      fail_msg("%s says something one way only", effect->id);
    if (!effect->amplitude_name != !effect->amplitude_symbol)
      fail_msg("the amplitude of %s has no name for people", effect->id);
    if (effect->glass && !effect->columns) fail_msg("%s has no columns", effect->id);
    if (fg_effect_is_free(effect) && !effect->moves) fail_msg("%s: what does it move?", effect->id);
    if (effect->shapes && !effect->starts == !effect->polynomial)
      fail_msg("%s: where is its shape sought?", effect->id);
    if ((effect->starts > 0) != (effect->start || effect->grid) ||
        (effect->shapes > 1) != !!effect->grid)
      fail_msg("%s: where do its shapes start?", effect->id);
    if (!fg_effect_is_free(effect) && !effect->width && !(effect->size_um[0] > 0))
      fail_msg("%s: how large is it?", effect->id);
    if (!(effect->size_um[0] > 0) != !effect->size_from)
      fail_msg("%s: where is its size from?", effect->id);
    for (size_t s = 0; s < effect->shapes; s++)
      if (!effect->shape_name[s] || !effect->shape_symbol[s])
        fail_msg("shape %zu of %s has no name", s, effect->id);
    assert_true(effect->second || fg_effect_find(effect->id) == effect);
  }
}

/* The renderer names its curves without the quantity that they move, and asks for missing
 * parameters in words other than those for a name that is not known. */
static void the_renderer_knows_every_row(void **state) {
  (void)state;
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    fg_context ctx = {0};
    fg_render_spec *spec = NULL;
    char text[200];
    const char *moved = strrchr(effect->id, '.');
    bool says_moved = !strcmp(moved, ".dx") || !strcmp(moved, ".dy");
    int length = (int)strlen(effect->id) - (says_moved ? 3 : 0);
    if (effect->scales || !strcmp(effect->id, "free.scan.xy"))
      continue; /* of the absolute size: two resolutions render it; over two axes: none draws it */
    snprintf(text, sizeof text,
             "{\"schema\":\"foilgauge/render/1\",\"foils\":[{}],\"effects\":[{\"id\":\"%.*s\"}]}",
             length, effect->id);
    if (fg_render_parse(&ctx, "spec", text, &spec) == FG_OK) fg_render_free(spec);
    if (strstr(ctx.message, "name of an effect")) fail_msg("not rendered: %s", effect->id);
  }
}

static void the_benchmark_draws_every_row(void **state) {
  (void)state;
  static char text[1 << 16];
  FILE *file = fopen("tests/bench/loop_cases.py", "r");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    if (!fg_effect_is_free(effect) && !effect->off_foils && !strstr(text, effect->id))
      fail_msg("not in the benchmark: %s", effect->id);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_effect_row_is_complete),
      cmocka_unit_test(the_search_knows_every_row),
      cmocka_unit_test(evidence_knows_every_row_that_the_search_does_not),
      cmocka_unit_test(lists_of_effects_are_checked),
      cmocka_unit_test(the_search_of_the_width_knows_every_row),
      cmocka_unit_test(the_renderer_knows_every_row),
      cmocka_unit_test(the_benchmark_draws_every_row),
  };
  return cmocka_run_group_tests_name("effects", tests, NULL, NULL);
}
