/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stated gauges: words and limits. */
#include "foilgauge/gauge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Limits of the width of a leaf, pin or ring on a scanner's bed, and of its uncertainty: a tenth of
 * the width is useless. */
#define WIDTH_MIN_MM 0.005
#define WIDTH_MAX_MM 200.0
#define LEAF_MAX_MM  10.0 /* the thickest leaf of a feeler gauge has 2 mm */
#define U_SHARE_MAX  0.1

static const char *const words[] = {"leaf", "pin", "ring", "hole"};
enum { KINDS = sizeof words / sizeof *words };

const char *fg_gauge_word(fg_gauge_kind kind) {
  return words[kind];
}

fg_status fg_gauge_check(fg_context *ctx, const char *name, const fg_gauge *gauge) {
  if (!(gauge->width_mm >= WIDTH_MIN_MM && gauge->width_mm <= WIDTH_MAX_MM))
    return fg_fail(ctx, FG_ERR_DATA, "%s: a width of %g mm; it must be from %g to %g mm", name,
                   gauge->width_mm, WIDTH_MIN_MM, WIDTH_MAX_MM);
  if (gauge->kind == FG_GAUGE_LEAF && gauge->width_mm > LEAF_MAX_MM)
    return fg_fail(ctx, FG_ERR_DATA, "%s: a leaf of %g mm: is it in mm? 100 µm is 0.1 mm", name,
                   gauge->width_mm);
  if (!(gauge->u_mm > 0))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: a standard uncertainty of %g mm; no width is known exactly: state it, as "
                   "0.0005",
                   name, gauge->u_mm);
  if (!(gauge->u_mm <= U_SHARE_MAX * gauge->width_mm))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: a standard uncertainty of %g mm; it must be at most a tenth of the width "
                   "of %g mm",
                   name, gauge->u_mm, gauge->width_mm);
  return FG_OK;
}

static const char *read_field(const char *text, double *value) {
  char *end;
  if (*text != ':') return NULL;
  *value = strtod(text + 1, &end);
  return end == text + 1 || !isfinite(*value) ? NULL : end;
}

fg_status fg_gauge_parse(fg_context *ctx, const char *text, fg_gauge *gauge) {
  for (int kind = 0; kind < KINDS; kind++) {
    size_t length = strlen(words[kind]);
    if (strncmp(text, words[kind], length) != 0 || text[length] != ':') continue;
    gauge->kind = (fg_gauge_kind)kind;
    const char *at = read_field(text + length, &gauge->width_mm);
    if (at) at = read_field(at, &gauge->u_mm);
    if (!at || *at) break;
    char name[80];
    snprintf(name, sizeof name, "gauge '%.60s'", text);
    return fg_gauge_check(ctx, name, gauge);
  }
  return fg_fail(ctx, FG_ERR_USAGE,
                 "gauge '%.60s' is not KIND:WIDTH:U, as leaf:0.1:0.0005: leaf, pin, ring or hole, "
                 "its known width in mm and the standard uncertainty of that in mm",
                 text);
}
