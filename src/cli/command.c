/* What every command does alike: reads its line, says why it failed. */
#include <argp.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/commands.h"

int fg_cli_fail(const fg_context *ctx, fg_status status) {
  fprintf(stderr, "foilgauge: %s\n", ctx->message);
  return fg_status_exit_code(status);
}

fg_status fg_cli_parse(fg_context *ctx, const struct argp *parser, int argc, char **argv,
                       void *input) {
  if (argp_parse(parser, argc, argv, 0, NULL, input) == 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the command line");
}

double fg_cli_number(struct argp_state *state, const char *name, const char *text, double lowest,
                     double highest) {
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end || !(value >= lowest && value <= highest))
    argp_error(state, "--%s: '%s' is not a number from %g to %g", name, text, lowest, highest);
  return value;
}
