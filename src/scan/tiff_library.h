/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libtiff, which is loaded for the first TIFF (core/library.h). */
#ifndef FG_SCAN_TIFF_LIBRARY_H
#define FG_SCAN_TIFF_LIBRARY_H

#include <tiffio.h>

#include "foilgauge/status.h"

/* clang-format off */
#define FG_TIFF_FUNCTIONS(F) \
  F(ClientOpenExt) \
  F(Close) \
  F(GetField) \
  F(GetFieldDefaulted) \
  F(IsByteSwapped) \
  F(IsCODECConfigured) \
  F(IsTiled) \
  F(LastDirectory) \
  F(NumberOfStrips) \
  F(OpenOptionsAlloc) \
  F(OpenOptionsFree) \
  F(OpenOptionsSetErrorHandlerExtR) \
  F(OpenOptionsSetMaxSingleMemAlloc) \
  F(OpenOptionsSetWarningHandlerExtR) \
  F(ReadEncodedStrip) \
  F(ReadRawStrip) \
  F(ReadRawTile) \
  F(ReadScanline) \
  F(ReadTile) \
  F(ReverseBits) \
  F(ScanlineSize64) \
  F(SetField) \
  F(SwabArrayOfShort) \
  F(TileSize64)
/* clang-format on */

/* Functions of libtiff, less the word TIFF in front. */
typedef struct fg_tiff_library {
#define FG_TIFF_POINTER(name) __typeof__(TIFF##name) *name;
  FG_TIFF_FUNCTIONS(FG_TIFF_POINTER)
#undef FG_TIFF_POINTER
} fg_tiff_library;

extern fg_tiff_library fg_libtiff; /* NULL before fg_tiff_library_load */

fg_status fg_tiff_library_load(fg_context *ctx);

#endif
