#include "cli/output_set.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool fg_is_standard(const char *path) {
  return !strcmp(path, "-");
}

bool fg_same_file(const char *a, const char *b) {
  struct stat stat_a, stat_b;
  if (!strcmp(a, b)) return true;
  if (stat(a, &stat_a) || stat(b, &stat_b)) return false;
  return S_ISREG(stat_a.st_mode) && stat_a.st_dev == stat_b.st_dev &&
         stat_a.st_ino == stat_b.st_ino;
}

fg_status fg_output_set_check(fg_context *ctx, const fg_output_set *set, const char *input,
                              const char *words) {
  for (size_t kind = 0; kind < set->count; kind++) {
    const char *path = set->path[kind];
    if (!path) continue;
    for (size_t other = 0; other < kind; other++)
      if (set->path[other] && fg_same_file(path, set->path[other]))
        return fg_fail(ctx, FG_ERR_USAGE, "%s: two outputs cannot go to one file", path);
    if (input && !fg_is_standard(path) && fg_same_file(path, input))
      return fg_fail(ctx, FG_ERR_USAGE, "%s: the output would overwrite %s", path, words);
  }
  return FG_OK;
}

fg_status fg_output_set_open(fg_context *ctx, fg_output_set *set) {
  for (size_t kind = 0; kind < set->count; kind++) {
    if (!set->path[kind]) continue;
    FG_TRY(fg_output_open(ctx, set->path[kind], &set->output[kind]));
    set->open[kind] = true;
  }
  return fg_interrupt_start(ctx, set->output, set->count, &set->interrupt);
}

static fg_status write_one(fg_context *ctx, fg_output_set *set, size_t kind,
                           fg_output_writer *writer, void *user) {
  fg_status status = writer(ctx, user, kind, set->output[kind].stream);
  if (status != FG_ERR_IO) return status;
  fg_context inner = *ctx;
  return fg_fail(ctx, status, "%.200s: %.800s",
                 fg_is_standard(set->path[kind]) ? "standard output" : set->path[kind],
                 inner.message);
}

/* An output that fails after another has its final name: none may look finished. */
static void take_back(const fg_output_set *set, size_t committed) {
  for (size_t kind = 0; kind < committed; kind++) {
    const char *path = set->path[kind];
    struct stat info;
    if (path && !fg_is_standard(path) && stat(path, &info) == 0 && S_ISREG(info.st_mode))
      unlink(path);
  }
}

fg_status fg_output_set_write(fg_context *ctx, fg_output_set *set, fg_output_writer *writer,
                              void *user) {
  for (int standard = 0; standard <= 1; standard++)
    for (size_t kind = 0; kind < set->count; kind++)
      if (set->open[kind] && fg_is_standard(set->path[kind]) == (standard == 1))
        FG_TRY(write_one(ctx, set, kind, writer, user));
  for (size_t kind = 0; kind < set->count; kind++) {
    if (!set->open[kind]) continue;
    fg_status status = fg_output_commit(ctx, &set->output[kind]);
    if (status == FG_OK) continue;
    take_back(set, kind);
    return status;
  }
  return FG_OK;
}

void fg_output_set_close(fg_output_set *set) {
  fg_interrupt_stop(&set->interrupt);
  for (size_t kind = 0; kind < set->count; kind++)
    if (set->open[kind]) fg_output_discard(&set->output[kind]);
}
