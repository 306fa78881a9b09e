/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/output_set.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool fg_is_standard(const char *path) {
  return !strcmp(path, "-");
}

bool fg_output_set_has_standard(const fg_output_set *set) {
  for (size_t kind = 0; kind < set->count; kind++)
    if (set->path[kind] && fg_is_standard(set->path[kind])) return true;
  return false;
}

void fg_output_set_choose_standard(fg_output_set *set, size_t json, size_t text, bool json_beside) {
  if (fg_output_set_has_standard(set)) return;
  if (isatty(STDOUT_FILENO)) {
    if (!set->path[text]) set->path[text] = "-";
    return;
  }
  for (size_t i = 0; i < set->count; i++)
    if (set->path[i] && (!json_beside || i == json)) return;
  set->path[json] = "-";
}

fg_status fg_output_set_check(fg_context *ctx, fg_output_set *set, const fg_input *inputs,
                              size_t count) {
  if (!set->overwrite.places)
    FG_TRY(fg_overwrite_begin(ctx, set->path, set->count, &set->overwrite));
  for (size_t i = 0; i < count; i++)
    FG_TRY(fg_overwrite_check(ctx, &set->overwrite, inputs[i].path, inputs[i].words));
  return FG_OK;
}

fg_status fg_output_set_open(fg_context *ctx, fg_output_set *set) {
  for (size_t kind = 0; kind < set->count; kind++) {
    if (!set->path[kind]) continue;
    FG_TRY(fg_output_open(ctx, set->path[kind], &set->output[kind]));
    set->open[kind] = true;
  }
  return FG_OK;
}

typedef struct kind_writing {
  fg_output_writer *writer;
  void *user;
  size_t kind;
} kind_writing;

static fg_status write_kind(fg_context *ctx, void *user, FILE *out) {
  const kind_writing *of = user;
  return of->writer(ctx, of->user, of->kind, out);
}

static fg_status write_one(fg_context *ctx, fg_output_set *set, size_t kind,
                           fg_output_writer *writer, void *user) {
  fg_output *output = &set->output[kind];
  kind_writing of = {writer, user, kind};
  bool decimal_comma = set->decimal_comma && set->csv >> kind & 1u;
  return fg_output_flush(ctx, output,
                         fg_csv_write(ctx, decimal_comma, write_kind, &of, output->stream));
}

/* Removes committed outputs when a later one fails: none may look finished. */
static void remove_committed(const fg_output_set *set, size_t committed) {
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
    remove_committed(set, kind);
    return status;
  }
  return FG_OK;
}

void fg_output_set_close(fg_output_set *set) {
  fg_overwrite_free(&set->overwrite);
  for (size_t kind = 0; kind < set->count; kind++)
    if (set->open[kind]) fg_output_discard(&set->output[kind]);
}

void fg_loop_outputs_choose(fg_output_set *set) {
  if (set->path[FG_LOOP_JSON] || fg_output_set_has_standard(set)) return;
  if (isatty(STDOUT_FILENO))
    set->path[FG_LOOP_TEXT] = "-";
  else if (!set->path[FG_LOOP_HTML] && !set->path[FG_LOOP_MODEL])
    set->path[FG_LOOP_JSON] = "-";
}
