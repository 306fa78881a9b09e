/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/header.h"

#include <math.h>

#define SNAP_DPI   0.02
#define ADVICE_DPI "give the resolution with --dpi"

/* pHYs counts whole pixels per metre, so 4800 dpi = 188976.38 per metre reads as 4799.99. */
static double snap_dpi(double dpi) {
  double whole = round(dpi);
  return fabs(dpi - whole) <= SNAP_DPI ? whole : dpi;
}

static bool is_plausible(double dpi) {
  return dpi >= FG_SCAN_DPI_MIN && dpi <= FG_SCAN_DPI_MAX;
}

fg_status fg_scan_check_dpi(fg_context *ctx, double dpi) {
  if (!isfinite(dpi) || dpi <= 0)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "a resolution of %g dpi makes no sense; " ADVICE_DPI " as a positive number",
                   dpi);
  if (!is_plausible(dpi))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "a resolution of %g dpi is outside %g to %g dpi; " ADVICE_DPI
                   " in dots per inch",
                   dpi, FG_SCAN_DPI_MIN, FG_SCAN_DPI_MAX);
  return FG_OK;
}

static fg_status check_file(fg_context *ctx, const char *name, const fg_scan_header *header) {
  if (header->no_dpi)
    return fg_fail(ctx, FG_ERR_DATA, "%s: does not say its resolution (%s); " ADVICE_DPI, name,
                   header->no_dpi);
  if (isnan(header->dpi[0]) || isnan(header->dpi[1]))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: cannot say its resolution (its format has none); " ADVICE_DPI, name);
  for (int axis = 0; axis < 2; axis++)
    if (!is_plausible(header->dpi[axis]))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: says %g dpi in %c (%s), which no scanner has; " ADVICE_DPI, name,
                     header->dpi[axis], "xy"[axis], header -> dpi_source);
  return FG_OK;
}

fg_status fg_resolution_find(fg_context *ctx, const char *name, const fg_scan_header *header,
                             double dpi, fg_scan_info *info) {
  for (int axis = 0; axis < 2; axis++)
    info->dpi_file[axis] = header->dpi[axis];
  if (dpi != 0) {
    info->dpi[0] = info->dpi[1] = dpi;
    return FG_OK;
  }
  FG_TRY(check_file(ctx, name, header));
  for (int axis = 0; axis < 2; axis++)
    info->dpi[axis] = snap_dpi(header->dpi[axis]);
  return FG_OK;
}
