/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots of two groups in memory, whose foils differ as asked and whose bumps scatter within them. */
#ifndef FG_TEST_GROUP_LOTS_H
#define FG_TEST_GROUP_LOTS_H

#include "support/made_lot.h"
#include "support/random.h"
#include "support/test.h"

enum { GROUP_FOILS = 14, GROUP_BUMPS = 9 };

typedef struct group_kind {
  size_t first;       /* foils of group A; the others are of group B */
  double foil_sd_mm;  /* between foils; bumps within a foil: 0.02 mm */
  double place_mm;    /* from one place to the next */
  size_t missing_max; /* bumps, at the first places of a foil */
  double shift_mm;    /* of group B */
  double long_tail;   /* of one foil: times its deviation; 1: normal */
} group_kind;

static const double group_bump_sd_mm = 0.02;

typedef struct group_lot {
  fg_lot lot;
  fg_lot_analysis analysis;
  size_t first;
} group_lot;

static inline void group_lot_make(const fg_design *design, size_t first, group_lot *g) {
  const char *cells[GROUP_FOILS];
  for (size_t i = 0; i < GROUP_FOILS; i++)
    cells[i] = i < first ? ",A" : ",B";
  *g =
      (group_lot){.lot = made_lot(design, GROUP_FOILS, GROUP_BUMPS, ",die", cells), .first = first};
  snprintf(g->lot.settings.group_column, sizeof g->lot.settings.group_column, "die");
  for (size_t i = 0; i < GROUP_FOILS; i++)
    for (size_t k = 0; k < GROUP_BUMPS; k++)
      made_bump(&g->lot, i, k, 3.36 + 0.001 * (double)((3 * i + k) % 5), 63.15);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &g->lot, &g->analysis));
}

static inline void group_lot_free(group_lot *g) {
  fg_lot_analysis_free(&g->analysis);
  made_lot_free(&g->lot);
}

/* Draws the foils anew and compares the groups. */
static inline void group_lot_draw(const group_kind *kind, uint64_t *seed, group_lot *g) {
  for (size_t i = 0; i < GROUP_FOILS; i++) {
    fg_foil *foil = &g->lot.records[i].foils[0];
    double level = kind->foil_sd_mm * random_gaussian(seed) * (i ? 1 : kind->long_tail);
    if (i >= g->first) level += kind->shift_mm;
    size_t missing = (size_t)(random_uniform(seed) * (double)(kind->missing_max + 1));
    foil->bump_count = GROUP_BUMPS - missing;
    for (size_t k = 0; k < foil->bump_count; k++) {
      foil->bumps[k].number = (int)(k + missing) + 1;
      double place = kind->place_mm * (double)(k + missing);
      made_bump(&g->lot, i, k, 3.36 + place + level + group_bump_sd_mm * random_gaussian(seed),
                63.15);
    }
  }
}

/* The labels anew: foils change places. */
static inline void group_lot_relabel(uint64_t *seed, group_lot *g) {
  for (size_t i = GROUP_FOILS - 1; i > 0; i--) {
    size_t k = (size_t)(random_uniform(seed) * (double)(i + 1));
    fg_foil kept = g->lot.records[i].foils[0];
    g->lot.records[i].foils[0] = g->lot.records[k].foils[0];
    g->lot.records[k].foils[0] = kept;
  }
}

static inline const fg_lot_difference *group_lot_compare(group_lot *g) {
  g->analysis.difference_count = 0;
  assert_ok(&test_context, fg_lot_analyse_groups(&test_context, &g->analysis));
  for (size_t i = 0; i < g->analysis.difference_count; i++)
    if (!strcmp(g->analysis.differences[i].quantity->row->name, "radius_mm"))
      return &g->analysis.differences[i];
  return NULL;
}

#endif
