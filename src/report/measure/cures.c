/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cures of a verdict of "cannot tell", the cheapest first. */
#include "report/measure/cures.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/traceability.h"

#include <stdlib.h>
#include <string.h>

#define NOT_KNOWN " U holds a tone curve of the scanner that is not known."

static const char micrometer[] =
    "Measure the strip's thickness by a micrometer and state it (--thickness-measured, or "
    "thickness_measured in the design)." NOT_KNOWN;
static const char gauge_diameter[] =
    "Lay a gauge of known diameter beside it (gauges), or state tone linear where the scanner's "
    "counts are proportional to the light." NOT_KNOWN;
static const char gauge_width[] =
    "Lay a gauge of known width beside it (gauges), or state tone linear where the scanner's "
    "counts are proportional to the light." NOT_KNOWN;
static const char midline[] =
    "Let the datum be the midline (datum mid), which a tone curve does not move, or lay a gauge of "
    "known width beside it (gauges)." NOT_KNOWN;

const char *fg_cure_of(const fg_design *design, const fg_quantity *row) {
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  bool of_strip = kind->has_bumps || !strncmp(row->name, "thickness", 9);
  if (!fg_design_may_judge(design)) return fg_traceability_cure;
  if (design->tone == FG_TONE_LINEAR) return NULL;
  if (row->uses & FG_QUANTITY_OF_DATUM && design->datum != FG_DATUM_MID) return midline;
  if (!(row->uses & FG_QUANTITY_BETWEEN_EDGES)) return NULL;
  if (!kind->is_foil) return gauge_diameter;
  if (!of_strip) return gauge_width;
  return design->thickness_measured_mm > 0 ? NULL : micrometer;
}

void fg_cures_add(fg_cures *cures, const fg_decision *decision) {
  for (size_t i = 0; i < decision->count; i++) {
    const char *cure = decision->judgements[i].cure;
    size_t k = 0;
    while (cure && k < cures->count && cures->list[k] != cure)
      k++;
    if (cure && k == cures->count && k < FG_CURES_MAX) cures->list[cures->count++] = cure;
  }
}
