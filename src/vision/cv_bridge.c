#include "vision/cv_bridge.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "vision/cv_module.h"

enum { PATH_BYTES = 4096 };

/* Beside the program, where it is installed beside the program, where it was built. */
static const char *const places[] = {"", "/../lib/foilgauge", NULL};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static const fg_cv_functions *loaded; /* NULL: `why` says what is wrong */
static char why[600];

static void find_program_folder(char folder[PATH_BYTES]) {
  ssize_t length = readlink("/proc/self/exe", folder, PATH_BYTES - 1);
  folder[length > 0 ? length : 0] = '\0';
  char *end = strrchr(folder, '/');
  if (end) *end = '\0';
}

static void take(void *module, const char *path) {
  const fg_cv_functions *found = dlsym(module, FG_CV_MODULE_SYMBOL);
  if (found && !strcmp(found->version, FOILGAUGE_VERSION))
    loaded = found;
  else
    snprintf(why, sizeof why, "%.400s: is of another version of foilgauge", path);
}

/* The first that is there is the one; it stays to the end. */
static void load(void) {
  char folder[PATH_BYTES], path[PATH_BYTES + 100];
  find_program_folder(folder);
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    snprintf(path, sizeof path, "%s%s/%s", places[i] ? folder : FOILGAUGE_MODULE_FOLDER,
             places[i] ? places[i] : "", FG_CV_MODULE_FILE);
    if (access(path, F_OK) != 0) continue;
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (module)
      take(module, path);
    else
      snprintf(why, sizeof why, "%.500s", dlerror());
    return;
  }
  snprintf(why, sizeof why, "%s: is not beside the program (%.400s), nor in ../lib/foilgauge",
           FG_CV_MODULE_FILE, folder);
}

static fg_status need(fg_context *ctx, const fg_cv_functions **functions) {
  pthread_once(&once, load);
  *functions = loaded;
  if (loaded) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "OpenCV cannot be loaded, which pictures and discs need: %s", why);
}

fg_status fg_cv_contours(fg_context *ctx, const uint8_t *picture, int32_t width, int32_t height,
                         double level, int32_t least, fg_contours *out) {
  const fg_cv_functions *cv;
  *out = (fg_contours){0};
  FG_TRY(need(ctx, &cv));
  return cv->contours(ctx, picture, width, height, level, least, out);
}

fg_status fg_cv_draw_line(fg_context *ctx, fg_rgb *rgb, const double *xy_px, size_t count,
                          uint32_t colour, int32_t thickness_px) {
  const fg_cv_functions *cv;
  FG_TRY(need(ctx, &cv));
  return cv->draw_line(ctx, rgb, xy_px, count, colour, thickness_px);
}

fg_status fg_cv_draw_text(fg_context *ctx, fg_rgb *rgb, const char *text, const double at_px[2],
                          const fg_text_style *style) {
  const fg_cv_functions *cv;
  FG_TRY(need(ctx, &cv));
  return cv->draw_text(ctx, rgb, text, at_px, style);
}

void fg_contours_free(fg_contours *contours) {
  if (!contours) return;
  free(contours->xy);
  free(contours->starts);
  *contours = (fg_contours){0};
}
