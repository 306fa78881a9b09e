/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quantity/quantity_rows.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "quantity/rows.h"

const fg_quantity *fg_quantities(fg_quantity_owner owner, size_t *count) {
  static const fg_quantity_rows *const tables[FG_QUANTITY_OWNERS] = {
      [FG_QUANTITY_OF_FOIL] = &fg_quantities_of_foil,
      [FG_QUANTITY_OF_BUMP] = &fg_quantities_of_bump,
      [FG_QUANTITY_OF_BEAM] = &fg_quantities_of_beam,
      [FG_QUANTITY_OF_DISC] = &fg_quantities_of_disc,
      [FG_QUANTITY_OF_STRIP] = &fg_quantities_of_strip,
      [FG_QUANTITY_OF_BEARING] = &fg_quantities_of_bearing,
  };
  *count = tables[owner]->count;
  return tables[owner]->rows;
}

bool fg_quantity_applies(fg_quantity_owner owner, const fg_quantity *quantity, fg_foil_kind kind) {
  const fg_foil_traits *traits = fg_foil_traits_of(kind);
  if (!(traits->owners & 1u << owner)) return false;
  if (owner != FG_QUANTITY_OF_FOIL) return true;
  return (quantity->uses & traits->foil_uses) == traits->foil_uses &&
         !(quantity->uses & traits->foil_not);
}

const fg_quantity *fg_quantity_find(fg_quantity_owner owner, const char *name) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++)
    if (!strcmp(rows[i].name, name)) return &rows[i];
  return NULL;
}

const fg_quantity *fg_quantity_of_bearing_for(const char *tolerance) {
  const fg_quantity_rows *bearing = &fg_quantities_of_bearing;
  for (size_t i = 0; i < bearing->count; i++)
    if (bearing->rows[i].tolerance && !strcmp(bearing->rows[i].tolerance, tolerance))
      return &bearing->rows[i];
  return NULL;
}

bool fg_quantity_has_u(const fg_quantity *quantity) {
  return quantity->u_offset != FG_NO_UNCERTAINTY;
}

size_t fg_quantity_values(const fg_quantity *quantity) {
  return quantity->kind == FG_QUANTITY_PAIR ? 2 : 1;
}

size_t fg_quantity_width(const fg_quantity *quantity) {
  return fg_quantity_values(quantity) * (fg_quantity_has_u(quantity) ? 2 : 1);
}

size_t fg_quantity_numbers(const fg_quantity *quantity, const void *object,
                           double numbers[FG_QUANTITY_NUMBERS_MAX]) {
  const char *from = object;
  size_t values = fg_quantity_values(quantity), whole;
  memcpy(numbers, from + quantity->offset, values * sizeof *numbers);
  if (quantity->kind == FG_QUANTITY_COUNT) {
    memcpy(&whole, from + quantity->offset, sizeof whole);
    numbers[0] = (double)whole;
  }
  if (fg_quantity_has_u(quantity))
    memcpy(numbers + values, from + quantity->u_offset, values * sizeof *numbers);
  return fg_quantity_width(quantity);
}

void fg_quantity_restore(const fg_quantity *quantity, void *object,
                         const double numbers[FG_QUANTITY_NUMBERS_MAX]) {
  static const double whole_max = 9007199254740992.0; /* 2^53: every whole number up to it */
  char *to = object;
  size_t values = fg_quantity_values(quantity);
  bool countable = numbers[0] >= 0 && numbers[0] < whole_max;
  size_t whole = countable ? (size_t)numbers[0] : 0;
  if (quantity->kind == FG_QUANTITY_COUNT)
    memcpy(to + quantity->offset, &whole, sizeof whole);
  else
    memcpy(to + quantity->offset, numbers, values * sizeof *numbers);
  if (fg_quantity_has_u(quantity))
    memcpy(to + quantity->u_offset, numbers + values, values * sizeof *numbers);
}

double fg_quantity_value(const fg_quantity *quantity, const void *object) {
  double numbers[FG_QUANTITY_NUMBERS_MAX];
  if (quantity->kind == FG_QUANTITY_PAIR) return NAN;
  fg_quantity_numbers(quantity, object, numbers);
  return numbers[0];
}

double fg_quantity_uncertainty(const fg_quantity *quantity, const void *object) {
  double numbers[FG_QUANTITY_NUMBERS_MAX];
  if (quantity->kind != FG_QUANTITY_NUMBER || !fg_quantity_has_u(quantity)) return NAN;
  fg_quantity_numbers(quantity, object, numbers);
  return numbers[1];
}

static bool reads_before(const fg_quantity *a, const fg_quantity *b) {
  return a->rank && (!b->rank || a->rank < b->rank);
}

size_t fg_quantity_shown(fg_quantity_owner owner, fg_quantity_use use, fg_foil_kind kind,
                         const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX]) {
  size_t count, used = 0;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count && used < FG_QUANTITY_SHOWN_MAX; i++) {
    if (!(rows[i].uses & use) || !fg_quantity_applies(owner, &rows[i], kind)) continue;
    size_t at = used++;
    for (; at > 0 && reads_before(&rows[i], shown[at - 1]); at--)
      shown[at] = shown[at - 1];
    shown[at] = &rows[i];
  }
  return used;
}

void fg_quantity_column(const fg_quantity *quantity, size_t k, char *text, size_t size) {
  size_t values = fg_quantity_values(quantity);
  const char *u = k < values ? "" : "u_", *unit = strrchr(quantity->name, '_');
  if (values == 1 || !unit)
    fg_text_clip(text, size, "%s%s", u, quantity->name);
  else
    fg_text_clip(text, size, "%s%.*s_%c%s", u, (int)(unit - quantity->name), quantity->name,
                 k % values ? 'y' : 'x', unit);
}

void fg_quantity_list(fg_quantity_owner owner, fg_foil_kind kind, bool counts, char *text,
                      size_t size) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    size_t used = strlen(text);
    if (!fg_quantity_applies(owner, &rows[i], kind)) continue;
    if (rows[i].kind == FG_QUANTITY_NUMBER || (counts && rows[i].kind == FG_QUANTITY_COUNT))
      fg_text_clip(text + used, size - used, "%s%s", used ? ", " : "", rows[i].name);
  }
}
