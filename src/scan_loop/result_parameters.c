/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of an effect with names and units that people read. */
#include <string.h>

#include "scan_loop/result.h"

/* Converts the names of fg_effect_found_number to names with units for people; ratios are in ppm.
 */
static void put_unit(const fg_effect *kind, fg_scan_result_parameter *p) {
  static const struct {
    const char *name, *people, *unit;
    double factor;
  } units[] = {{"value", "q", "ppm", 1e6},
               {"amplitude_um", "a", "µm", 1},
               {"phase_deg", "φ", "°", 1},
               {"lobes", "n", "", 1}};
  p->symbol = p->name;
  p->unit = "";
  p->told = p->value;
  p->u_told = p->u;
  if (p->name == kind->amplitude_name) {
    p->symbol = kind->amplitude_symbol;
    p->unit = "µm";
    return;
  }
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (strcmp(p->name, units[i].name) != 0) continue;
    p->symbol = units[i].people;
    p->unit = units[i].unit;
    p->told *= units[i].factor;
    p->u_told *= units[i].factor;
    return;
  }
  for (size_t s = 0; s < kind->shapes; s++)
    if (p->name == kind->shape_name[s]) {
      p->symbol = kind->shape_symbol[s];
      p->unit = kind->shape_is[s] == FG_EFFECT_GROWTH ? "/mm" : kind->midline ? "°" : "mm";
    }
}

size_t
fg_scan_result_put_parameters(const fg_effect_found *effect,
                              fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS]) {
  size_t i = 0;
  for (; i < FG_SCAN_RESULT_PARAMETERS; i++) {
    fg_scan_result_parameter *p = &parameter[i];
    *p = (fg_scan_result_parameter){0};
    if (!fg_effect_found_number(effect, i, &p->name, &p->value, &p->u)) break;
    put_unit(effect->kind, p);
    if (effect->kind->numbers == FG_EFFECT_LED)
      p->told = effect->coefficient_um[0]; /* with its sign */
    if (effect->kind->numbers == FG_EFFECT_OVAL && i == 1) p->symbol = "ψ0";
  }
  return i;
}
