/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/quantity_json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "quantity/quantity_rows.h"

static void write_quantity(fg_json *json, const fg_quantity *quantity, const char *name,
                           const double *numbers) {
  char u_name[64];
  snprintf(u_name, sizeof u_name, "u_%s", name);
  switch (quantity->kind) {
  case FG_QUANTITY_PAIR:
    fg_json_numbers(json, name, numbers, 2);
    if (fg_quantity_has_u(quantity)) fg_json_numbers(json, u_name, numbers + 2, 2);
    break;
  case FG_QUANTITY_NUMBER:
    fg_json_number(json, name, numbers[0]);
    if (fg_quantity_has_u(quantity)) fg_json_number(json, u_name, numbers[1]);
    break;
  case FG_QUANTITY_COUNT:
    fg_json_integer(json, name, (int64_t)numbers[0]);
    break;
  }
}

void fg_json_quantities(fg_json *json, fg_quantity_owner owner, const char *group,
                        const void *object, bool known) {
  size_t count, prefix = strlen(group);
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    const char *name = rows[i].name;
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    if (prefix ? strncmp(name, group, prefix) != 0 : strchr(name, '.') != NULL) continue;
    size_t width = fg_quantity_numbers(&rows[i], object, numbers);
    for (size_t k = 0; k < width && !known && rows[i].kind != FG_QUANTITY_COUNT; k++)
      numbers[k] = NAN;
    write_quantity(json, &rows[i], name + prefix, numbers);
  }
}
