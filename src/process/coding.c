/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors to -1 and +1, responses to the sign that is modelled. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "foilgauge/doe.h"

fg_status fg_coding_parse(fg_context *ctx, const char *text, fg_coding *coding) {
  const char *equals = strrchr(text, '=');
  const char *colon = equals ? strchr(equals, ':') : NULL;
  *coding = (fg_coding){0};
  if (!equals || !colon || equals == text)
    return fg_fail(ctx, FG_ERR_USAGE, "coding '%s': NAME=LOW:HIGH is expected", text);
  size_t length = (size_t)(equals - text);
  if (length >= sizeof coding->name)
    return fg_fail(ctx, FG_ERR_USAGE, "coding '%s': the name is too long", text);
  memcpy(coding->name, text, length);
  if (!fg_extended_parse(equals + 1, (size_t)(colon - equals - 1), &coding->low) ||
      !fg_extended_parse(colon + 1, strlen(colon + 1), &coding->high))
    return fg_fail(ctx, FG_ERR_USAGE, "coding '%s': LOW and HIGH must be numbers", text);
  if (!(fg_extended_subtract(coding->high, coding->low).value > 0))
    return fg_fail(ctx, FG_ERR_USAGE, "coding '%s': LOW must be below HIGH", text);
  return FG_OK;
}

fg_status fg_rounding_parse(fg_context *ctx, const char *text, fg_rounding *rounding) {
  const char *equals = strrchr(text, '=');
  char *end;
  *rounding = (fg_rounding){0};
  if (!equals || equals == text)
    return fg_fail(ctx, FG_ERR_USAGE, "'%s': NAME=STEP is expected", text);
  size_t length = (size_t)(equals - text);
  if (length >= sizeof rounding->name)
    return fg_fail(ctx, FG_ERR_USAGE, "'%s': the name is too long", text);
  memcpy(rounding->name, text, length);
  rounding->step = strtod(equals + 1, &end);
  if (end == equals + 1 || *end || !(rounding->step > 0) || !isfinite(rounding->step))
    return fg_fail(ctx, FG_ERR_USAGE, "'%s': STEP must be a number above 0", text);
  return FG_OK;
}

/* By its decimal text, so that 3 steps of 0.1 are 0.3 and not 0.30000000000000004. */
double fg_round_to(double value, double step) {
  char text[40];
  if (!(step > 0)) return value;
  snprintf(text, sizeof text, "%.12g", step * round(value / step));
  return strtod(text, NULL);
}

fg_status fg_coding_from_data(fg_context *ctx, const fg_table *table, const char *name,
                              fg_coding *coding) {
  const fg_extended *x = NULL;
  *coding = (fg_coding){0};
  FG_TRY(fg_table_numbers(ctx, table, name, &x));
  if (strlen(name) >= sizeof coding->name)
    return fg_fail(ctx, FG_ERR_USAGE, "the name of column '%s' is too long", name);
  memcpy(coding->name, name, strlen(name));
  for (size_t i = 0; i < table->rows; i++) {
    if (!i || fg_extended_subtract(x[i], coding->low).value < 0) coding->low = x[i];
    if (!i || fg_extended_subtract(x[i], coding->high).value > 0) coding->high = x[i];
  }
  if (fg_extended_subtract(coding->high, coding->low).value > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "column '%s' holds one value only: it cannot be coded", name);
}

static fg_extended centre_of(const fg_coding *coding) {
  return fg_extended_multiply(fg_extended_add(coding->low, coding->high), fg_extended_of(0.5));
}

static fg_extended half_of(const fg_coding *coding) {
  return fg_extended_multiply(fg_extended_subtract(coding->high, coding->low), fg_extended_of(0.5));
}

static fg_extended to_coded(const fg_coding *coding, fg_extended real) {
  return fg_extended_divide(fg_extended_subtract(real, centre_of(coding)), half_of(coding));
}

double fg_coding_to_real(const fg_coding *coding, double coded) {
  fg_extended step = fg_extended_multiply(fg_extended_of(coded), half_of(coding));
  return fg_extended_add(centre_of(coding), step).value;
}

/* Returns the table's own column for writing, after checking that it has numbers only. */
static fg_status numbers_to_change(fg_context *ctx, fg_table *table, const char *name,
                                   fg_extended **numbers) {
  const fg_extended *checked = NULL;
  FG_TRY(fg_table_numbers(ctx, table, name, &checked));
  for (size_t i = 0; i < table->columns; i++)
    if (table->column[i].number == checked) *numbers = table->column[i].number;
  return FG_OK;
}

fg_status fg_coding_apply(fg_context *ctx, const fg_coding *coding, fg_table *table) {
  fg_extended *x = NULL;
  FG_TRY(numbers_to_change(ctx, table, coding->name, &x));
  for (size_t i = 0; i < table->rows; i++)
    x[i] = to_coded(coding, x[i]);
  return FG_OK;
}

fg_status fg_response_apply(fg_context *ctx, fg_response_sign sign, const char *name,
                            fg_table *table) {
  fg_extended *y = NULL;
  FG_TRY(numbers_to_change(ctx, table, name, &y));
  for (size_t i = 0; i < table->rows; i++)
    if (sign == FG_RESPONSE_NEGATED || (sign == FG_RESPONSE_MAGNITUDE && y[i].value < 0))
      y[i] = fg_extended_negate(y[i]);
  return FG_OK;
}

double fg_doe_relative_effect_pct(const fg_regression *regression, size_t column) {
  if (!regression->constant || column == 0) return NAN;
  return 100 * regression->coefficient[column].estimate / regression->coefficient[0].estimate;
}
