/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/library.h"

#include <dlfcn.h>
#include <string.h>

static fg_status find_functions(fg_context *ctx, const fg_library *library) {
  void *handle = dlopen(library->file, RTLD_NOW | RTLD_LOCAL);
  if (!handle)
    return fg_fail(ctx, FG_ERR_IO, "%s cannot be loaded: install %s (Debian, Ubuntu)",
                   library->file, library->package);
  for (size_t i = 0; i < library->count; i++) {
    void *function = dlsym(handle, library->names[i]);
    if (!function)
      return fg_fail(ctx, FG_ERR_IO, "%s has no %s: update %s", library->file, library->names[i],
                     library->package);
    memcpy((char *)library->functions + i * sizeof function, &function, sizeof function);
  }
  return FG_OK;
}

fg_status fg_library_load(fg_context *ctx, fg_library *library) {
  pthread_mutex_lock(&library->mutex);
  fg_status status = library->loaded ? FG_OK : find_functions(ctx, library);
  if (status == FG_OK && !library->loaded && library->start) library->start();
  library->loaded = status == FG_OK;
  pthread_mutex_unlock(&library->mutex);
  return status;
}
