/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/cv_bridge.h"

#include <dlfcn.h>
#include <link.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

static pthread_once_t once = PTHREAD_ONCE_INIT;
static const fg_cv_functions *loaded; /* NULL: `why` names the error */
static char why[600];

/* Places of the module in the build tree and when installed, from the folder of the binary that
 * contains this code: a program, or the shared library, whose folder may be lib/TRIPLET. */
static const char *const of_program[] = {"", "/../lib/foilgauge", NULL};
static const char *const of_library[] = {"", "/foilgauge", "/../foilgauge", NULL};

/* Finds the binary's folder. The program's own name is only its caller's claim, so the system is
 * asked. */
static const char *const *find_own_folder(char folder[PATH_BYTES]) {
  struct link_map *map = NULL;
  Dl_info info;
  bool library =
      dladdr1(&once, &info, (void **)&map, RTLD_DL_LINKMAP) != 0 && map && map->l_name[0];
  ssize_t length = library ? snprintf(folder, PATH_BYTES, "%s", map->l_name)
                           : readlink("/proc/self/exe", folder, PATH_BYTES - 1);
  folder[length > 0 && length < PATH_BYTES ? length : 0] = '\0';
  char *end = strrchr(folder, '/');
  if (end) *end = '\0';
  return library ? of_library : of_program;
}

/* Finds the first place that has the module; false: none. */
static bool find_module(char path[PATH_BYTES + 100]) {
  char folder[PATH_BYTES];
  const char *const *place = find_own_folder(folder);
  for (; *place; place++) {
    snprintf(path, PATH_BYTES + 100, "%s%s/%s", folder, *place, FG_CV_MODULE_FILE);
    if (access(path, F_OK) == 0) return true;
  }
  snprintf(path, PATH_BYTES + 100, "%s/%s", FOILGAUGE_MODULE_FOLDER, FG_CV_MODULE_FILE);
  if (access(path, F_OK) == 0) return true;
  snprintf(why, sizeof why, "%s: is neither in %.400s nor in ../lib/foilgauge", FG_CV_MODULE_FILE,
           folder);
  return false;
}

static void open_module(void *module, const char *path) {
  const fg_cv_functions *found = dlsym(module, FG_CV_MODULE_SYMBOL);
  if (found && !strcmp(found->version, FOILGAUGE_VERSION))
    loaded = found;
  else
    snprintf(why, sizeof why, "%.400s: is of another version of foilgauge", path);
}

/* Loads the first module found; it stays loaded to the end. */
static void load_module(void) {
  char path[PATH_BYTES + 100];
  if (!find_module(path)) return;
  void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (module)
    open_module(module, path);
  else
    snprintf(why, sizeof why, "%.500s", dlerror());
}

static fg_status require_module(fg_context *ctx, const fg_cv_functions **functions) {
  pthread_once(&once, load_module);
  *functions = loaded;
  if (loaded) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "OpenCV cannot be loaded, which pictures and discs need: %s", why);
}

fg_status fg_cv_contours(fg_context *ctx, const uint8_t *picture, int32_t width, int32_t height,
                         double level, int32_t min, fg_contours *out) {
  const fg_cv_functions *cv;
  *out = (fg_contours){0};
  FG_TRY(require_module(ctx, &cv));
  return cv->contours(ctx, picture, width, height, level, min, out);
}

fg_status fg_cv_draw_line(fg_context *ctx, fg_rgb *rgb, const double *xy_px, size_t count,
                          uint32_t colour, int32_t thickness_px) {
  const fg_cv_functions *cv;
  FG_TRY(require_module(ctx, &cv));
  return cv->draw_line(ctx, rgb, xy_px, count, colour, thickness_px);
}

fg_status fg_cv_draw_text(fg_context *ctx, fg_rgb *rgb, const char *text, const double at_px[2],
                          const fg_text_style *style) {
  const fg_cv_functions *cv;
  FG_TRY(require_module(ctx, &cv));
  return cv->draw_text(ctx, rgb, text, at_px, style);
}

void fg_contours_free(fg_contours *contours) {
  if (!contours) return;
  free(contours->xy);
  free(contours->starts);
  *contours = (fg_contours){0};
}
