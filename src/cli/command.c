/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts that all commands share: reading the command line, reporting a failure. */
#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "foilgauge/picture.h"

int fg_cli_fail(const fg_context *ctx, fg_status status) {
  fprintf(stderr, "foilgauge: %s\n", ctx->message);
  return fg_status_exit_code(status);
}

void fg_cli_note_picture(const char *scan, unsigned findings) {
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
    if (findings & words->finding)
      fprintf(stderr, "foilgauge: note: %s: state of the picture: %s: %s\n", scan, words->name,
              words->meaning);
}

/* Answers --help wherever it stands: argp would read it as the value of an option before it
 * (`loop --table --help`). */
static void answer_help(const struct argp *parser, int argc, char **argv) {
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
    if (strcmp(argv[i], "--help") != 0) continue;
    argp_help(parser, stdout, ARGP_HELP_STD_HELP, argv[0]);
    exit(0);
  }
}

static fg_status parse_command_line(fg_context *ctx, const struct argp *parser, unsigned flags,
                                    int argc, char **argv, void *input) {
  answer_help(parser, argc, argv);
  if (argp_parse(parser, argc, argv, flags, NULL, input) == 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the command line");
}

fg_status fg_cli_parse(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                       void *input) {
  return parse_command_line(ctx, parser, 0, argc, argv, input);
}

fg_status fg_cli_parse_in_order(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                                void *input) {
  return parse_command_line(ctx, parser, ARGP_IN_ORDER, argc, argv, input);
}

double fg_cli_number(struct argp_state *state, const char *name, const char *text, double lowest,
                     double highest) {
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end || !(value >= lowest && value <= highest))
    argp_error(state, "--%s: '%s' is not a number from %g to %g", name, text, lowest, highest);
  return value;
}

double fg_cli_positive(struct argp_state *state, const char *name, const char *text) {
  char *end;
  double value = strtod(text, &end);
  if (*end || end == text || !(value > 0))
    argp_error(state, "--%s: '%s' is not a number above 0", name, text);
  return value;
}

bool fg_cli_is_second(struct argp_state *state, const char *name, const char *text,
                      const char *first, const char *second) {
  if (strcmp(text, first) != 0 && strcmp(text, second) != 0)
    argp_error(state, "--%s: '%s' is neither %s nor %s", name, text, first, second);
  return !strcmp(text, second);
}

uint64_t fg_cli_seed(struct argp_state *state, const char *text) {
  char *end;
  uint64_t seed = strtoull(text, &end, 10);
  if (*end || end == text || *text == '-')
    argp_error(state, "--seed: '%s' is not a whole number from 0", text);
  return seed;
}

fg_lot_shard fg_cli_shard(struct argp_state *state, const char *text) {
  static const char digits[] = "0123456789";
  unsigned long long index = 0, count = 0;
  size_t before = strspn(text, digits), behind = 0;
  if (before && text[before] == '/') behind = strspn(text + before + 1, digits);
  bool known = behind && !text[before + 1 + behind] && before < 19 && behind < 19 &&
               sscanf(text, "%llu/%llu", &index, &count) == 2;
  if (!known || index < 1 || index > count || count > FG_CLI_SHARDS_MAX)
    argp_error(state, "--shard: '%s' is not I/N with I from 1 to N", text);
  return (fg_lot_shard){(size_t)index, (size_t)count};
}
