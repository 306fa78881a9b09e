/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One foil measures the same, to the last bit, wherever it lies on the glass and whatever lies
 * beside it; only its place moves. */
#include "support/measured_render.h"

#include "support/random.h"
#include "support/test.h"

enum { ROOM = 300 }; /* px that a foil can be moved by */

/* A picture on the 16-bit scale. */
typedef struct sheet {
  int64_t width, height;
  int bits;
  uint16_t *pixels;
} sheet;

static fg_status take_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  sheet *s = user;
  (void)ctx;
  for (int64_t x = 0; x < s->width; x++)
    s->pixels[row * s->width + x] = s->bits > 8 ? ((const uint16_t *)pixels)[x]
                                                : (uint16_t)(((const uint8_t *)pixels)[x] * 257);
  return FG_OK;
}

static sheet render_sheet(const char *scanner, int bumps, const char *foil) {
  fg_context ctx = {0};
  fg_render_spec *spec;
  char json[3000];
  small_foil(json, sizeof json, bumps, foil, "%s", scanner);
  if (fg_render_parse(&ctx, "spec", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  const fg_render_truth *truth = fg_render_get_truth(spec);
  sheet s = {.width = truth->width_px, .height = truth->height_px, .bits = truth->bits};
  s.pixels = calloc((size_t)(s.width * s.height), sizeof *s.pixels);
  assert_non_null(s.pixels);
  assert_ok(&ctx, fg_render_rows(&ctx, spec, 0, take_row, &s));
  fg_render_free(spec);
  return s;
}

/* An empty bed with noise of its own. */
static sheet make_bed(const sheet *like, int64_t width, int64_t height, uint64_t seed) {
  sheet bed = {.width = width, .height = height, .bits = like->bits};
  bed.pixels = calloc((size_t)(width * height), sizeof *bed.pixels);
  assert_non_null(bed.pixels);
  double background = like->pixels[0] / 257.0;
  for (int64_t i = 0; i < width * height; i++) {
    double value = background + random_gaussian(&seed);
    bed.pixels[i] = (uint16_t)(like->bits > 8 ? lround(value * 257) : 257 * lround(value));
  }
  return bed;
}

static void paste(const sheet *from, int64_t x, int64_t y, sheet *bed) {
  for (int64_t row = 0; row < from->height; row++)
    memcpy(bed->pixels + (y + row) * bed->width + x, from->pixels + row * from->width,
           (size_t)from->width * sizeof *from->pixels);
}

static void add_rows(fg_context *ctx, const sheet *bed, fg_session *session, fg_tiles *tiles) {
  for (int32_t strip = 0; strip < tiles->rows; strip++) {
    void *rows = fg_tiles_strip(tiles, strip);
    int64_t count = fg_tiles_strip_rows(tiles, strip) * bed->width;
    const uint16_t *from = bed->pixels + (int64_t)strip * FG_TILE_PX * bed->width;
    for (int64_t i = 0; i < count; i++)
      if (bed->bits > 8)
        ((uint16_t *)rows)[i] = from[i];
      else
        ((uint8_t *)rows)[i] = (uint8_t)(from[i] / 257);
    assert_ok(ctx, fg_tiles_accept_strip(ctx, tiles));
    assert_ok(ctx, fg_session_advance(ctx, tiles, session));
  }
}

static fg_measurement measure_bed(const sheet *bed, double dpi) {
  fg_context ctx = {0};
  fg_measurement m = {.dpi = {dpi, dpi}};
  fg_tiles tiles;
  fg_session *session;
  fg_design_default(&m.design);
  assert_ok(&ctx, fg_design_derive(&ctx, &m.design, &m.nominal));
  assert_ok(&ctx,
            fg_tiles_create(&ctx, bed->width, bed->height, bed->bits > 8 ? 2 : 1, NULL, &tiles));
  assert_ok(&ctx, fg_session_create(&ctx, &m, 1, true, &session));
  add_rows(&ctx, bed, session, &tiles);
  assert_ok(&ctx, fg_tiles_finish(&ctx, &tiles));
  assert_ok(&ctx, fg_session_advance(&ctx, &tiles, session));
  assert_ok(&ctx, fg_session_finish(&ctx, session));
  fg_session_free(session);
  fg_tiles_free(&tiles);
  return m;
}

/* All that is no place on the glass, bit by bit. */
static void assert_same(const fg_foil *a, const fg_foil *b) {
  assert_int_equal(a->bump_count, b->bump_count);
  assert_true(a->bump_count > 0 && !(a->flags & FG_FOIL_NOT_MEASURED));
  assert_int_equal(a->flags, b->flags);
  assert_memory_equal(&a->thickness.mm, &b->thickness.mm, sizeof a->thickness.mm);
  fg_overall p = a->overall, q = b->overall;
  p.centre_mm = q.centre_mm = (fg_point){0, 0};
  assert_memory_equal(&p, &q, sizeof p);
  for (size_t i = 0; i < a->bump_count; i++) {
    fg_bump u = a->bumps[i], v = b->bumps[i];
    u.centre_mm = v.centre_mm = (fg_point){0, 0};
    assert_memory_equal(&u, &v, sizeof u);
  }
  assert_int_equal(a->strip.count, b->strip.count);
  for (size_t i = 0; i < a->strip.count; i++) {
    const fg_station *s = &a->strip.stations[i], *t = &b->strip.stations[i];
    assert_memory_equal(&s->s_mm, &t->s_mm, sizeof s->s_mm);
    assert_memory_equal(&s->normal, &t->normal, sizeof s->normal);
    assert_memory_equal(&s->u_left_um, &t->u_left_um, sizeof s->u_left_um);
    assert_memory_equal(&a->labels[i].residual_left_um, &b->labels[i].residual_left_um,
                        sizeof a->labels[i].residual_left_um);
  }
}

static fg_measurement measure_at(const sheet *foil, int64_t x, int64_t y, double dpi,
                                 uint64_t seed) {
  sheet bed = make_bed(foil, foil->width + ROOM, foil->height + ROOM, seed);
  paste(foil, x, y, &bed);
  fg_measurement m = measure_bed(&bed, dpi);
  assert_int_equal(m.foil_count, 1);
  free(bed.pixels);
  return m;
}

static void moved(const char *scanner, double dpi) {
  static const int places[][2] = {{128, 129}, {129, 128}, {131, 167}, {97, 80}, {192, 192}};
  sheet foil = render_sheet(scanner, 3, "");
  fg_measurement first = measure_at(&foil, 128, 128, dpi, 1);
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    in_row("places[%zu]", i);
    fg_measurement m = measure_at(&foil, places[i][0], places[i][1], dpi, 2 + i);
    assert_same(&first.foils[0], &m.foils[0]);
    for (int k = 0; k < 2; k++)
      assert_int_equal(m.foils[0].strip.box_px[k] - first.foils[0].strip.box_px[k],
                       places[i][k] - 128);
    fg_measurement_free(&m);
  }
  fg_measurement_free(&first);
  free(foil.pixels);
}

static void a_foil_does_not_depend_on_its_place(void **state) {
  (void)state;
  moved("\"dpi\":1600,\"noise\":1", 1600);
}

static void a_dark_16_bit_scan_measures_the_same_after_a_move(void **state) {
  (void)state;
  moved("\"dpi\":1600,\"noise\":2,\"bits\":16,\"background\":220,\"contrast\":-170", 1600);
}

static void foils_beside_it_do_not_change_a_measurement(void **state) {
  (void)state;
  const double dpi = 1600;
  const char *scanner = "\"dpi\":1600,\"noise\":1";
  sheet above = render_sheet(scanner, 3, ""), below = render_sheet(scanner, 4, "");
  fg_measurement alone[2] = {measure_at(&above, 150, 150, dpi, 1),
                             measure_at(&below, 150, 150, dpi, 2)};
  sheet bed = make_bed(&above, below.width + ROOM, above.height + below.height + 2 * ROOM, 3);
  paste(&above, 77, 141, &bed);
  paste(&below, 103, 141 + above.height + 90, &bed);
  fg_measurement both = measure_bed(&bed, dpi);
  assert_int_equal(both.foil_count, 2);
  for (int i = 0; i < 2; i++) {
    assert_same(&alone[i].foils[0], &both.foils[i]);
    fg_measurement_free(&alone[i]);
  }
  fg_measurement_free(&both);
  free(bed.pixels);
  free(above.pixels);
  free(below.pixels);
}

/* First pixel of the foil in reading order, or the last one. */
static int64_t find_outermost(const sheet *s, bool last) {
  int64_t count = s->width * s->height, limit = s->pixels[0] + 60 * 257;
  for (int64_t i = 0; i < count; i++) {
    int64_t at = last ? count - 1 - i : i;
    if (s->pixels[at] > limit) return at;
  }
  fail_msg("no foil");
  return 0;
}

/* The bed with noise of its own in some of its rows. */
static fg_measurement measure_without_rows(const sheet *bed, int64_t from, int64_t to, double dpi) {
  sheet empty = make_bed(bed, bed->width, bed->height, 4), erased = *bed;
  size_t row = (size_t)bed->width, begin = (size_t)from * row, end = (size_t)to * row;
  erased.pixels = malloc((size_t)bed->height * row * sizeof *erased.pixels);
  assert_non_null(erased.pixels);
  memcpy(erased.pixels, bed->pixels, (size_t)bed->height * row * sizeof *erased.pixels);
  memcpy(erased.pixels + begin, empty.pixels + begin, (end - begin) * sizeof *erased.pixels);
  fg_measurement m = measure_bed(&erased, dpi);
  assert_int_equal(m.foil_count, 1);
  free(erased.pixels);
  free(empty.pixels);
  return m;
}

/* Two foils so near to each other that tiles which hold them may touch. */
static void a_neighbour_on_the_next_tile_does_not_change_a_measurement(void **state) {
  (void)state;
  enum { GAP = 84, KEPT = 60, LEFT = 1400 };
  const double dpi = 1600;
  const char *scanner = "\"dpi\":1600,\"noise\":1";
  sheet above = render_sheet(scanner, 3, ""), below = render_sheet(scanner, 4, "");
  int64_t low = find_outermost(&above, true), high = find_outermost(&below, false);
  for (int64_t y = 100; y < 100 + FG_TILE_PX; y += 16) {
    in_row("y = %d", (int)y);
    int64_t end = y + low / above.width + 1, next = end + GAP;
    sheet bed = make_bed(&above, above.width + below.width + 2 * LEFT,
                         above.height + below.height + 2 * ROOM, 3);
    paste(&below, LEFT + low % above.width - high % below.width, next - high / below.width, &bed);
    above.height = end + GAP / 2 - y; /* its margin would hide the other foil */
    paste(&above, LEFT, y, &bed);
    fg_measurement both = measure_bed(&bed, dpi);
    fg_measurement alone[2] = {measure_without_rows(&bed, end + KEPT, bed.height, dpi),
                               measure_without_rows(&bed, 0, next - KEPT, dpi)};
    assert_int_equal(both.foil_count, 2);
    for (int i = 0; i < 2; i++) {
      assert_same(&alone[i].foils[0], &both.foils[i]);
      fg_measurement_free(&alone[i]);
    }
    fg_measurement_free(&both);
    free(bed.pixels);
  }
  free(above.pixels);
  free(below.pixels);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_foil_does_not_depend_on_its_place),
      cmocka_unit_test(a_dark_16_bit_scan_measures_the_same_after_a_move),
      cmocka_unit_test(foils_beside_it_do_not_change_a_measurement),
      cmocka_unit_test(a_neighbour_on_the_next_tile_does_not_change_a_measurement),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
