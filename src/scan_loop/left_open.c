/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/left_open.h"

#include "evidence/unnamed.h"

static bool is_loose(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++)
    if (model->part[k]->rival && model->part[k]->rival->loose) return true;
  return false;
}

bool fg_scan_loop_is_loose(const fg_evidence_verdict *v) {
  return v->ties && is_loose(&v->tie[0]);
}

static bool is_of_part_alone(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++)
    if (model->part[k]->effect ? model->part[k]->effect->glass != NULL
                               : model->part[k]->rival->glass != NULL)
      return false;
  return true;
}

/* Returns true for a model with a free form of the whole foil. */
static bool holds_foil_field(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_rival *rival = model->part[k]->rival;
    if (rival && !rival->glass && rival->coordinate == FG_EFFECT_FOIL) return true;
  }
  return false;
}

static bool is_seen_once(const fg_edge_fit *edge_fit) {
  return edge_fit->view_count == edge_fit->part_count;
}

static bool holds_fault_at_one_place(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_effect *effect = model->part[k]->effect;
    if (effect && fg_unnamed_is_of_one_place(effect)) return true;
  }
  return false;
}

/* One scan shows a fault of the picture at one place, and a dent of whatever shape, alike. */
bool fg_scan_loop_is_split_open(const fg_edge_fit *edge_fit, const fg_evidence_verdict *v) {
  for (size_t k = 0; k < v->ties; k++)
    if (is_of_part_alone(&v->tie[k]) ||
        (is_seen_once(edge_fit) && holds_fault_at_one_place(&v->tie[k])))
      return true;
  return false;
}

bool fg_scan_loop_is_beside_foil_field(const fg_edge_fit *edge_fit, const fg_evidence_verdict *v) {
  for (size_t k = 0; k < v->ties; k++)
    if (is_seen_once(edge_fit) && holds_foil_field(&v->tie[k])) return true;
  return false;
}
