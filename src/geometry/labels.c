/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/labels.h"

#include <math.h>

#include "core/memory.h"
#include "geometry/arcs.h"

/* Residuals of one station of an arc. `outward_is_inner`: the shaft's side is the one away from
 * the circle's centre, as on a bump. */
static void fill_residuals(const fg_layout *layout, const fg_arc *arc, size_t k, fg_datum datum,
                           bool outward_is_inner, fg_station_label *label) {
  const fg_station *s = &layout->line.strip->stations[k];
  double half = 0.5 * layout->line.strip->thickness_mm;
  double to_inner = outward_is_inner ? half : -half;
  double middle = datum == FG_DATUM_MID ? 0 : datum == FG_DATUM_INNER ? -to_inner : to_inner;
  double right = layout->inner_is_right ? to_inner : -to_inner;
  double shift = layout->line.blur_mm * layout->line.blur_mm / (2 * arc->circle.radius);
  label->residual_um = (float)(1000 * fg_arc_residual(&layout->line, &arc->circle, k));
  if (!(s->weight > 0)) return;
  label->residual_left_um =
      (float)(1000 * (fg_circle_distance(&arc->circle, s->left) - middle + right + shift));
  label->residual_right_um =
      (float)(1000 * (fg_circle_distance(&arc->circle, s->right) - middle - right + shift));
}

/* A land or a bump: its stations, and the arc that they are held against. */
typedef struct labelled_arc {
  const fg_arc *arc;
  fg_range range;
  fg_arc_kind kind;
  int number;
} labelled_arc;

static void label_arc(const fg_layout *layout, const labelled_arc *part, fg_datum datum,
                      fg_foil *foil) {
  for (size_t k = part->range.first; k <= part->range.last; k++) {
    fg_station_label *label = &foil->labels[k];
    label->kind = part->kind;
    label->number = part->number;
    label->fitted = fg_arc_used(&layout->line, part->arc, k);
    fill_residuals(layout, part->arc, k, datum, part->kind == FG_ARC_BUMP, label);
  }
}

/* Labels the remaining stations: between the first and last arc fillet; beyond them lip or free
 * end. */
static void label_remaining(const fg_layout *layout, fg_foil *foil) {
  size_t count = foil->strip.count, first = count, last = 0;
  for (size_t k = 0; k < count; k++)
    if (foil->labels[k].kind != FG_ARC_NONE) {
      if (first == count) first = k;
      last = k;
    }
  for (size_t k = 0; k < count; k++) {
    fg_station_label *label = &foil->labels[k];
    if (label->kind != FG_ARC_NONE) continue;
    if (k < first)
      label->kind = layout->turning.lip_first ? FG_ARC_LIP : FG_ARC_END;
    else if (k > last)
      label->kind = layout->turning.lip_last ? FG_ARC_LIP : FG_ARC_END;
    else
      label->kind = FG_ARC_FILLET;
  }
}

/* The number of the bump whose arc starts at a station's arc length. */
static int bump_number_at(const fg_foil *foil, double s_mm) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].arc_start_mm == s_mm) return foil->bumps[i].number;
  return 0;
}

fg_status fg_labels_fill(fg_context *ctx, const fg_layout *layout, fg_datum datum, fg_foil *foil) {
  size_t count = foil->strip.count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *foil->labels, (void **)&foil->labels));
  for (size_t k = 0; k < count; k++)
    foil->labels[k].residual_um = foil->labels[k].residual_left_um =
        foil->labels[k].residual_right_um = NAN;
  bool reversed = foil->bump_count > 1 &&
                  foil->bumps[0].arc_start_mm > foil->bumps[foil->bump_count - 1].arc_start_mm;
  for (size_t i = 0; i < layout->land_count; i++) {
    int number = (int)(reversed ? layout->land_count - i : i + 1);
    const labelled_arc land = {&layout->overall, layout->lands[i], FG_ARC_LAND, number};
    label_arc(layout, &land, datum, foil);
  }
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    if (layout->fitted[i]) {
      fg_range range = layout->bump_ranges[i];
      int number = bump_number_at(foil, foil->strip.stations[range.first].s_mm);
      const labelled_arc bump = {&layout->bumps[i], range, FG_ARC_BUMP, number};
      label_arc(layout, &bump, datum, foil);
    }
  label_remaining(layout, foil);
  return FG_OK;
}
