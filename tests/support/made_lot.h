/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lot of foils in memory, as if its records had been read. */
#ifndef FG_TEST_MADE_LOT_H
#define FG_TEST_MADE_LOT_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lot/statistics/analysis.h"
#include "support/test.h"

/* `columns`: further columns of the manifest with a leading comma, or ""; `cells` their text for
 * each foil (NULL: none). Scans are 0.png, 1.png, ... with a foil each, whose bumps are zero. */
static inline fg_lot made_lot(const fg_design *design, size_t foils, size_t bumps,
                              const char *columns, const char *const *cells) {
  fg_lot lot = {0};
  fg_context ctx;
  char text[16384];
  int used = snprintf(text, sizeof text, "scan%s\n", columns);
  for (size_t i = 0; i < foils; i++)
    used +=
        snprintf(text + used, sizeof text - (size_t)used, "%zu.png%s\n", i, cells ? cells[i] : "");
  fg_lot_settings_default(&lot.settings);
  lot.settings.design = *design;
  lot.settings.resamples = 100;
  assert_ok(&ctx, fg_design_derive(&ctx, design, &lot.nominal));
  assert_ok(&ctx, fg_manifest_parse(&ctx, "made.csv", text, "", &lot.manifest));
  assert_int_equal(lot.manifest.items, foils);
  memset(lot.head.recipe_sha256, 'a', sizeof lot.head.recipe_sha256 - 1);
  memset(lot.head.manifest_sha256, 'b', sizeof lot.head.manifest_sha256 - 1);
  lot.records = calloc(foils, sizeof *lot.records);
  for (size_t i = 0; i < foils; i++) {
    fg_record *record = &lot.records[i];
    record->scan = lot.manifest.cell[i * lot.manifest.columns];
    record->foils = calloc(1, sizeof *record->foils);
    record->foil_count = 1;
    fg_foil *foil = &record->foils[0];
    *foil = (fg_foil){
        .number = 1, .thickness = {.mm = design->thickness_mm, .u_mm = 1e-5}, .bump_count = bumps};
    foil->overall.radius_mm = design->overall_radius_mm;
    foil->bumps = calloc(bumps, sizeof *foil->bumps);
    for (size_t k = 0; k < bumps; k++)
      foil->bumps[k].number = (int)k + 1;
  }
  return lot;
}

static inline void made_lot_free(fg_lot *lot) {
  for (size_t i = 0; i < lot->manifest.items; i++) {
    free(lot->records[i].foils[0].bumps);
    free(lot->records[i].foils);
  }
  free(lot->records);
  fg_manifest_free(&lot->manifest);
}

/* A bump of this radius and angle on the foil's overall circle, with all that follows from it. */
static inline void made_bump(const fg_lot *lot, size_t foil, size_t k, double radius_mm,
                             double angle_deg) {
  fg_foil *f = &lot->records[foil].foils[0];
  double half = angle_deg * 3.14159265358979323846 / 360, r0 = f->overall.radius_mm;
  double chord = radius_mm * sin(half);
  f->bumps[k].radius_mm = radius_mm;
  f->bumps[k].centre_mm.x = radius_mm * cos(half) + sqrt(r0 * r0 - chord * chord);
  const fg_thickness strip = fg_foil_thickness(&lot->settings.design, f);
  fg_bump_derive(&lot->settings.design, &lot->nominal, &f->overall, &strip, &f->bumps[k]);
}

#endif
