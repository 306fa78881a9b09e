/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bumps that are missing or crushed, in every combination: the others keep their numbers, no land
 * becomes a bump, and the defect is named. The strip is the renderer's true midline. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/foil.h"
#include "foilgauge/render.h"
#include "support/brief.h"
#include "support/test.h"

enum { BUMPS = 9 };
static const double step_mm = 0.02;

/* The listed members of `spec`'s only foil, as a list of numbers: [2,5]. */
static void list_bits(unsigned set, char *text) {
  strcpy(text, "[");
  for (int i = 0; i < BUMPS; i++)
    if (set & 1u << i) sprintf(text + strlen(text), "%s%d", strlen(text) > 1 ? "," : "", i + 1);
  strcat(text, "]");
}

static fg_render_spec *parse(const char *members) {
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  char json[2048];
  snprintf(json, sizeof json,
           "{\"schema\":\"foilgauge/render/1\",\"seed\":7,\"foils\":[{\"overall_radius_mm\":20.95,"
           "\"radius_springback\":{\"mean\":0.02,\"sd\":0.007}%s}]}",
           members);
  if (fg_render_parse(&ctx, "spec", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  return spec;
}

/* Stations along the true midline; `backwards` from the free end. */
static fg_strip strip_of(const fg_render_spec *spec, bool backwards) {
  fg_context ctx = {0};
  const double mm = 25.4 / fg_render_get_truth(spec)->dpi[0], half = 0.05;
  fg_strip strip = {.step_mm = step_mm, .thickness_mm = 2 * half, .u_thickness_mm = 1e-5};
  fg_point p;
  size_t max = 8000;
  fg_point *points = calloc(max, sizeof *points);
  while (strip.count < max &&
         fg_render_midline(&ctx, spec, 0, (double)strip.count * step_mm, &p) == FG_OK)
    points[strip.count++] = (fg_point){p.x * mm, p.y * mm};
  strip.stations = calloc(strip.count, sizeof *strip.stations);
  uint32_t random = 1;
  for (size_t i = 0; i < strip.count; i++) {
    size_t last = strip.count - 1, k = backwards ? last - i : i;
    fg_point a = points[k > 0 ? k - 1 : 0], b = points[k < last ? k + 1 : last], at = points[k];
    double sign = backwards ? -1 : 1, dx = sign * (b.x - a.x), dy = sign * (b.y - a.y);
    double d = hypot(dx, dy), nx = -dy / d, ny = dx / d;
    random = random * 1664525 + 1013904223;
    double noise = ((double)(random >> 8) / 0x1p24 - 0.5) * 5e-4;
    strip.stations[i] =
        (fg_station){.s_mm = (double)i * step_mm,
                     .left = {at.x + (noise - half) * nx, at.y + (noise - half) * ny},
                     .right = {at.x + (noise + half) * nx, at.y + (noise + half) * ny},
                     .normal = {nx, ny},
                     .u_left_um = 0.15f,
                     .u_right_um = 0.15f,
                     .weight = i < 5 || i + 5 >= strip.count ? 0 : 1};
  }
  free(points);
  return strip;
}

static fg_foil measure(const fg_render_spec *spec, bool backwards) {
  fg_context ctx = {0};
  fg_design design;
  fg_design_default(&design);
  fg_foil foil = {.strip = strip_of(spec, backwards)};
  assert_ok(&ctx, fg_foil_measure(&ctx, &design, 1, &foil));
  return foil;
}

/* Every bump of the foil is a true one under its own number. */
static void check(const fg_render_spec *spec, const fg_foil *foil, const char *members) {
  const fg_render_foil *truth = fg_render_get_truth(spec)->foils;
  if (*foil->error) fail_msg("%s: %s", members, foil->error);
  if (foil->bump_count != truth->bump_count)
    fail_msg("%s: %zu bumps, not %zu", members, foil->bump_count, truth->bump_count);
  bool missing = truth->bump_count < BUMPS;
  if (missing != !!(foil->flags & FG_FOIL_MISSING_BUMP))
    fail_msg("%s: missing_bump is %s", members, missing ? "not set" : "set");
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *b = &foil->bumps[i];
    const fg_render_bump *t = &truth->bumps[i];
    if (b->number != t->index) fail_msg("%s: bump %d is called %d", members, t->index, b->number);
    if (!(fabs(b->height_mm - t->height_mm) < (t->crushed ? 0.05 : 0.001)))
      fail_msg("%s: bump %d: height %g, not %g", members, t->index, b->height_mm, t->height_mm);
    if (!!(b->flags & FG_BUMP_CRUSHED) != t->crushed)
      fail_msg("%s: bump %d is %s", members, t->index,
               t->crushed ? "crushed and not flagged" : "sound and flagged as crushed");
  }
}

/* Every sound bump is found under its own number; R0 and the heights are the true ones. */
static void check_sound(const fg_render_spec *spec, const fg_foil *foil, const char *members) {
  const fg_render_foil *truth = fg_render_get_truth(spec)->foils;
  size_t found = 0;
  if (*foil->error) fail_msg("%s: %s", members, foil->error);
  if (!(fabs(foil->overall.radius_mm - 20.95) < 0.002))
    fail_msg("%s: an overall radius of %g", members, foil->overall.radius_mm);
  for (size_t k = 0; k < truth->bump_count; k++)
    for (size_t i = 0; i < foil->bump_count && !truth->bumps[k].crushed; i++) {
      if (foil->bumps[i].number != truth->bumps[k].index) continue;
      found++;
      if (!(fabs(foil->bumps[i].height_mm - truth->bumps[k].height_mm) < 0.001))
        fail_msg("%s: bump %d: height %g", members, foil->bumps[i].number,
                 foil->bumps[i].height_mm);
    }
  for (size_t k = 0; k < truth->bump_count; k++)
    found += truth->bumps[k].crushed;
  if (found != truth->bump_count) fail_msg("%s: a sound bump is not found", members);
}

static void run(const char *members, bool backwards) {
  fg_render_spec *spec = parse(members);
  fg_foil foil = measure(spec, backwards);
  check(spec, &foil, members);
  fg_foil_free(&foil);
  fg_render_free(spec);
}

/* All sets of bumps but the empty one; each under one kind of lip, from either end of the strip. */
static void any_bumps_may_be_missing(void **state) {
  (void)state;
  static const char *lips[] = {"", ",\"mirror\":true", ",\"lip\":{\"side\":\"inwards\"}",
                               ",\"lip\":{\"bend_radius_mm\":0.8}", ",\"lip\":null"};
  for (unsigned set = 0; set + 1 < 1u << BUMPS; set += test_step(9)) {
    char members[200], list[60];
    list_bits(set, list);
    snprintf(members, sizeof members, ",\"rotate_deg\":%u,\"missing\":%s%s", set % 360, list,
             lips[set % 5]);
    run(members, set / 5 % 2);
  }
}

/* Any number of crushed bumps, more or less so: they are flagged and no other is. */
static void any_bumps_may_be_crushed(void **state) {
  (void)state;
  static const double factors[] = {0.5, 0.4, 0.3};
  const unsigned skipped = getenv("FOILGAUGE_TEST_BRIEF") ? 8 : 0;
  for (unsigned set = 0; set < 1u << BUMPS; set += 1 + set % 3 + skipped) {
    char members[1000] = ",\"crushed\":[";
    for (int i = 0; i < BUMPS; i++)
      if (set & 1u << i)
        sprintf(members + strlen(members), "%s{\"bump\":%d,\"height_factor\":%g}",
                members[strlen(members) - 1] == '[' ? "" : ",", i + 1, factors[set % 3]);
    strcat(members, "]");
    run(members, set / 2 % 2);
  }
}

/* Bumps between others that are crushed until they are hardly seen leave the others and the overall
 * circle alone. */
static void flat_bumps_move_nothing(void **state) {
  (void)state;
  for (unsigned set = 1; set < 1u << (BUMPS - 2); set += test_step(7)) {
    char members[1000] = ",\"crushed\":[";
    for (int i = 0; i < BUMPS - 2; i++)
      if (set & 1u << i)
        sprintf(members + strlen(members), "%s{\"bump\":%d,\"height_factor\":%g}",
                members[strlen(members) - 1] == '[' ? "" : ",", i + 2, set % 2 ? 0.3 : 0.15);
    strcat(members, "]");
    fg_render_spec *spec = parse(members);
    fg_foil foil = measure(spec, set / 2 % 2);
    check_sound(spec, &foil, members);
    fg_foil_free(&foil);
    fg_render_free(spec);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_bumps_may_be_missing),
      cmocka_unit_test(any_bumps_may_be_crushed),
      cmocka_unit_test(flat_bumps_move_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
