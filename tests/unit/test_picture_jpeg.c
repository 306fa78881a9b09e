/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality of a JPEG that became a PNG, from its pixels, and its share of the uncertainty. */
#include "support/measured_render.h"
#include "support/test.h"

#define PLAIN "\"dpi\":2400,\"blur_px\":1.0,\"noise\":1.5,\"background\":30,\"contrast\":160"

static fg_strip strip_of(const char *scanner) {
  char json[4096];
  small_foil(json, sizeof json, 2, "", "%s", scanner);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  fg_strip strip = m.result.foils[0].strip; /* of which only numbers are used */
  measured_free(&m);
  return strip;
}

static void quality_is_found(void **unused) {
  (void)unused;
  static const int qualities[] = {40, 60, 75, 85, 90};
  for (size_t i = 0; i < sizeof qualities / sizeof *qualities; i++) {
    in_row("qualities[%zu]", i);
    char scanner[512];
    snprintf(scanner, sizeof scanner, PLAIN ",\"rough\":{\"jpeg\":{\"quality\":%d}}", qualities[i]);
    fg_strip strip = strip_of(scanner);
    assert_near(strip.picture.block_quality, qualities[i], 1);
    assert_true(strip.loss_um > 0 && strip.loss_variance > 0);
  }
}

static void scans_without_jpeg_have_no_block_quality(void **unused) {
  (void)unused;
  static const char *const scanners[] = {
      PLAIN, PLAIN ",\"noise_correlation\":0.6", PLAIN ",\"levels\":16",
      PLAIN ",\"unsharp_mask\":{\"amount_pct\":100,\"radius_px\":1}"};
  for (size_t i = 0; i < sizeof scanners / sizeof *scanners; i++) {
    in_row("scanners[%zu]", i);
    fg_strip strip = strip_of(scanners[i]);
    assert_int_equal(strip.picture.block_quality, 0);
    assert_true(strip.loss_um == 0 && strip.loss_variance == 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quality_is_found),
      cmocka_unit_test(scans_without_jpeg_have_no_block_quality),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
