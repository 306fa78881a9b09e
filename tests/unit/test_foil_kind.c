/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every table knows every kind of foil, and no result depends on what another kind's dimensions in
 * the union are. */
#include "foilgauge/foil_kind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/design_report.h"
#include "foilgauge/stiffness.h"
#include "foilgauge/words.h"
#include "geometry/foil_kind.h"
#include "report/design/members.h"
#include "report/measure/foil_view.h"
#include "support/test.h"

static const fg_foil_kind all_kinds[FG_FOIL_KINDS] = {FG_FOIL_CLASSICAL,  FG_FOIL_SINUSOIDAL,
                                                      FG_FOIL_DISCS,      FG_FOIL_ARC,
                                                      FG_FOIL_CANTILEVER, FG_FOIL_GRID};

static void every_row_is_whole(void **state) {
  (void)state;
  for (int i = 0; i < FG_FOIL_KINDS; i++) {
    const fg_foil_row *row = fg_foil_row_of(all_kinds[i]);
    const fg_foil_traits *traits = &row->traits;
    fg_foil_kind found;
    in_row("%s", traits->name);
    assert_true(fg_foil_kind_find(traits->name, &found) && found == all_kinds[i]);
    assert_true(traits->noun && traits->group != FG_DESIGN_COMMON && row->check);
    assert_true(traits->owners &
                1u << (traits->is_plain_strip ? FG_QUANTITY_OF_FOIL : traits->part));
    assert_true(!traits->is_foil || (row->min_object_mm && traits->parts_file));
    assert_true(!traits->is_foil || traits->lies_flat || (row->lay_out && row->fill));
    assert_true(traits->is_plain_strip == (traits->ranked_by != NULL));
    assert_true(!traits->is_plain_strip || (traits->plural && traits->own_quantities));
    assert_int_equal(traits->built_in, !traits->needed[0]);
  }
}

static void every_kind_has_a_view(void **state) {
  (void)state;
  for (int i = 0; i < FG_FOIL_KINDS; i++) {
    const fg_foil_view *view = fg_foil_view_of(all_kinds[i]);
    in_row("%s", fg_foil_kind_word(all_kinds[i]));
    assert_true(view->legend && view->overlay_note && view->points_heading && view->summary_heads);
    assert_true(view->u_from && view->parts && view->members);
    assert_true(view->design_table && view->foil_heading && view->page_heading);
    assert_true(view->tiles && view->details && view->overlay);
  }
}

/* The manual's text on `form` is this member's. */
static void manual_explains_every_kind(void **state) {
  (void)state;
  const fg_member *kind = fg_design_members.rows;
  while (kind->kind == FG_MEMBER_HEAD || strcmp(kind->name, "form") != 0)
    kind++;
  for (int i = 0; i < FG_FOIL_KINDS; i++) {
    char quoted[40];
    snprintf(quoted, sizeof quoted, "\"%s\" (", fg_foil_kind_word(all_kinds[i]));
    in_row("%s", quoted);
    assert_has(kind->words, quoted);
  }
}

static void a_list_reads_as_a_sentence(void **state) {
  (void)state;
  char list[200];
  fg_foil_kind_list(true, "", " or ", list, sizeof list);
  assert_string_equal(list, "classical, sinusoidal or discs");
}

/* Bytes of the union that the kind's own dimensions take. */
static size_t own_bytes(fg_design_group group) {
  static const size_t bytes[FG_DESIGN_GROUPS] = {[FG_DESIGN_BUMPS] = sizeof(fg_design_bumps),
                                                 [FG_DESIGN_BEAMS] = sizeof(fg_design_beams),
                                                 [FG_DESIGN_DISCS] = sizeof(fg_design_discs),
                                                 [FG_DESIGN_ARC] = sizeof(fg_design_arc),
                                                 [FG_DESIGN_GRID] = sizeof(fg_design_grid)};
  return bytes[group];
}

static const char *const design_texts[FG_FOIL_KINDS] = {
    [FG_FOIL_CLASSICAL] = "\"form\": \"classical\", \"bump_count\": 7",
    [FG_FOIL_SINUSOIDAL] = "\"form\": \"sinusoidal\", \"bump_count\": 7",
    [FG_FOIL_DISCS] = "\"form\": \"discs\", \"diameters_mm\": [4, 6.5]",
    [FG_FOIL_ARC] = "\"form\": \"arc\", \"overall_radius_mm\": 20, \"subtended_angle_deg\": 90, "
                    "\"thickness_mm\": 0.1",
    [FG_FOIL_CANTILEVER] = "\"form\": \"cantilever\", \"beam_length_mm\": 9, \"beam_width_mm\": 3, "
                           "\"thickness_mm\": 0.1, \"sagitta_mm\": 1",
    [FG_FOIL_GRID] = "\"form\": \"grid\", \"marks\": \"crosses\", \"pitch_mm\": 2"};

static fg_design design_of(fg_foil_kind kind) {
  fg_design design;
  char json[300];
  snprintf(json, sizeof json, "{\"schema\": \"foilgauge/design/1\", %s}", design_texts[kind]);
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_parse(&test_context, "x", json, &design));
  assert_int_equal(design.kind, kind);
  return design;
}

/* Everything that is written of a design. */
static char *written(const fg_design *design) {
  char *text = NULL;
  size_t size;
  fg_nominal nominal;
  const fg_arch_material material = fg_arch_material_default();
  FILE *out = open_memstream(&text, &size);
  assert_ok(&test_context, fg_design_derive(&test_context, design, &nominal));
  const fg_design_report report = {.design = design, .nominal = &nominal, .material = &material};
  assert_ok(&test_context, fg_design_write_json(&test_context, &report, out));
  assert_ok(&test_context, fg_design_write_table(&test_context, &report, out));
  fprintf(out, "parts %zu\n", fg_design_stated_parts(design));
  fclose(out);
  return text;
}

static void dimensions_of_other_kinds_are_not_read(void **state) {
  (void)state;
  for (int i = 0; i < FG_FOIL_KINDS; i++) {
    fg_design design = design_of(all_kinds[i]);
    char *plain = written(&design);
    size_t own = own_bytes(fg_foil_traits_of(design.kind)->group);
    in_row("%s", fg_foil_kind_word(design.kind));
    memset((char *)&design.values + own, 0xff, sizeof design.values - own); /* NaN */
    char *poisoned = written(&design);
    assert_string_equal(plain, poisoned);
    free(plain);
    free(poisoned);
  }
}

static void a_changed_kind_begins_at_its_defaults(void **state) {
  (void)state;
  fg_design usual, design = design_of(FG_FOIL_CLASSICAL);
  fg_design_default(&usual);
  assert_ok(&test_context, fg_design_become(&test_context, FG_FOIL_SINUSOIDAL, &design));
  assert_int_equal(design.bumps.count, 7);
  assert_ok(&test_context, fg_design_become(&test_context, FG_FOIL_DISCS, &design));
  assert_int_equal(design.discs.count, 0);
  assert_ok(&test_context, fg_design_become(&test_context, FG_FOIL_CLASSICAL, &design));
  assert_memory_equal(&design.bumps, &usual.bumps, sizeof design.bumps);
}

static void stated_dimensions_are_not_dropped_unsaid(void **state) {
  (void)state;
  fg_design arc = design_of(FG_FOIL_ARC);
  fg_context ctx = {.message = ""};
  assert_int_equal(fg_design_become(&ctx, FG_FOIL_CLASSICAL, &arc), FG_ERR_DATA);
  assert_has(ctx.message, "subtended_angle_deg belongs to form \"arc\" only");
  assert_int_equal(arc.kind, FG_FOIL_ARC);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_row_is_whole),
      cmocka_unit_test(every_kind_has_a_view),
      cmocka_unit_test(manual_explains_every_kind),
      cmocka_unit_test(a_list_reads_as_a_sentence),
      cmocka_unit_test(dimensions_of_other_kinds_are_not_read),
      cmocka_unit_test(a_changed_kind_begins_at_its_defaults),
      cmocka_unit_test(stated_dimensions_are_not_dropped_unsaid),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
