#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz.h"

const char *fuzz_file(const uint8_t *data, size_t size) {
  static int descriptor = -1;
  static char path[64];
  if (descriptor < 0) {
    descriptor = memfd_create("fuzz", MFD_CLOEXEC);
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
  }
  if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, data, size, 0) != (ssize_t)size) abort();
  return path;
}

void fuzz_read_scan(const char *path, const fg_scan_options *options) {
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  if (fg_scan_open(&ctx, path, options, &scan) != FG_OK) return;
  const fg_scan_info *info = fg_scan_get_info(scan);
  int64_t stride = info->width_px * info->bytes_per_pixel;
  void *row = malloc((size_t)stride);
  for (int64_t y = 0; row && y < info->height_px; y++)
    if (fg_scan_read_rows(&ctx, scan, 1, row, stride) != FG_OK) break;
  free(row);
  fg_scan_close(scan);
}
