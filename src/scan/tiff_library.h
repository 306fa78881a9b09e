/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libtiff, which is loaded for the first TIFF (core/library.h). */
#ifndef FG_SCAN_TIFF_LIBRARY_H
#define FG_SCAN_TIFF_LIBRARY_H

#include <tiffio.h>

#include "core/library.h"

/* clang-format off */
#define FG_TIFF_FUNCTIONS(F) \
  F(TIFF, ClientOpenExt) \
  F(TIFF, Close) \
  F(TIFF, GetField) \
  F(TIFF, GetFieldDefaulted) \
  F(TIFF, IsByteSwapped) \
  F(TIFF, IsCODECConfigured) \
  F(TIFF, IsTiled) \
  F(TIFF, LastDirectory) \
  F(TIFF, NumberOfStrips) \
  F(TIFF, OpenOptionsAlloc) \
  F(TIFF, OpenOptionsFree) \
  F(TIFF, OpenOptionsSetErrorHandlerExtR) \
  F(TIFF, OpenOptionsSetMaxSingleMemAlloc) \
  F(TIFF, OpenOptionsSetWarningHandlerExtR) \
  F(TIFF, ReadEncodedStrip) \
  F(TIFF, ReadRawStrip) \
  F(TIFF, ReadRawTile) \
  F(TIFF, ReadScanline) \
  F(TIFF, ReadTile) \
  F(TIFF, ReverseBits) \
  F(TIFF, ScanlineSize64) \
  F(TIFF, SetField) \
  F(TIFF, SwabArrayOfShort) \
  F(TIFF, TileSize64)
/* clang-format on */

/* Functions of libtiff, less the word TIFF in front. */
typedef struct fg_tiff_library {
  FG_TIFF_FUNCTIONS(FG_LIBRARY_POINTER)
} fg_tiff_library;

extern fg_tiff_library fg_libtiff; /* NULL before fg_tiff_library_load */

fg_status fg_tiff_library_load(fg_context *ctx);

#endif
