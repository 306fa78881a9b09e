/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/header.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SNAP_DPI   0.02
#define ROUND_DPI  50.0 /* resolutions of scanners are multiples of it */
#define ADVICE_DPI "give the resolution with --dpi"

/* Resolutions whose ratio is whole but for so much, and no more than this, are averaged. */
#define RATIO_ERROR  1e-3
#define AVERAGED_MAX 8

void fg_scan_warn(char *warning, size_t size, const char *format, ...) {
  va_list values;
  size_t used = strlen(warning);
  if (used > 0 && used + 2 < size) used += (size_t)snprintf(warning + used, size - used, "; ");
  va_start(values, format);
  vsnprintf(warning + used, size - used, format, values);
  va_end(values);
}

/* pHYs counts whole pixels per metre, so 4800 dpi = 188976.38 per metre reads as 4799.99. Of whole
 * dots per cm, rounded or cut off, 1200 dpi = 472.44 per cm reads as 1198.88: the round number
 * within one dot is the scanner's. */
static double snap_dpi(double dpi, double step) {
  double whole = round(dpi), round_number = ROUND_DPI * round(dpi / ROUND_DPI);
  if (fabs(dpi - whole) <= SNAP_DPI) return whole;
  return fabs(dpi - round_number) < step ? round_number : dpi;
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

/* Returns by which whole number the finer resolution exceeds the coarser one; 1: by none. */
static int whole_ratio(double finer, double coarser) {
  double ratio = finer / coarser, whole = round(ratio);
  return whole <= AVERAGED_MAX && fabs(ratio / whole - 1) <= RATIO_ERROR ? (int)whole : 1;
}

/* Makes pixels square: an edge that is blurred alike in all directions is to be so in pixels. */
static void average_finer(fg_scan_info *info) {
  int finer = info->dpi[0] > info->dpi[1] ? 0 : 1;
  int ratio = whole_ratio(info->dpi[finer], info->dpi[1 - finer]);
  if (ratio == 1) return;
  fg_scan_warn(info->warning, sizeof info->warning,
               "it has %.6g × %.6g dpi: every %d %s were averaged to one, so that pixels are square",
               info->dpi[0], info->dpi[1], ratio, finer ? "rows" : "columns");
  info->averaged[finer] = ratio;
  info->dpi[finer] /= ratio;
}

static fg_status find_dpi(fg_context *ctx, const char *name, const fg_scan_header *header,
                          double dpi, fg_scan_info *info) {
  if (dpi != 0) {
    info->dpi[0] = info->dpi[1] = dpi;
    return FG_OK;
  }
  FG_TRY(check_file(ctx, name, header));
  for (int axis = 0; axis < 2; axis++)
    info->dpi[axis] = snap_dpi(header->dpi[axis], header->dpi_step);
  if (fabs(info->dpi[0] - header->dpi[0]) > SNAP_DPI ||
      fabs(info->dpi[1] - header->dpi[1]) > SNAP_DPI)
    fg_scan_warn(info->warning, sizeof info->warning,
                 "it counts whole dots per cm, %.6g × %.6g dpi: %.6g × %.6g were taken",
                 header->dpi[0], header->dpi[1], info->dpi[0], info->dpi[1]);
  return FG_OK;
}

fg_status fg_resolution_find(fg_context *ctx, const char *name, const fg_scan_header *header,
                             const fg_scan_options *options, fg_scan_info *info) {
  for (int axis = 0; axis < 2; axis++) {
    info->dpi_file[axis] = header->dpi[axis];
    info->averaged[axis] = options->averaged[axis] ? options->averaged[axis] : 1;
  }
  FG_TRY(find_dpi(ctx, name, header, options->dpi, info));
  if (options->dpi == 0 && !options->averaged[0]) average_finer(info);
  info->width_px /= info->averaged[0];
  info->height_px /= info->averaged[1];
  return FG_OK;
}
