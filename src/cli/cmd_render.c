/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foilgauge render: a spec in, a scan and its truth out. */
#include <argp.h>
#include <stdlib.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/output_set.h"
#include "foilgauge/render.h"

typedef struct render_arguments {
  const char *spec, *scan, *truth;
} render_arguments;

static const struct argp_option options[] = {
    {"output", 'o', "SCAN.png", 0, "Where the scan goes (PNG, gray); - is standard output", 0},
    {"truth", 't', "F.json", 0, "Where the true dimensions go", 0},
    {0},
};

static const char doc[] =
    "Render a scan of foils as SPEC.json describes them, and the truth about it.\v"
    "samples/render/clean.json, rough.json, harsh.json and driver_*.json are specs to start from; "
    "include/foilgauge/render.h lists their members. The same spec gives the same bytes."
    "\n\n@exit_done@";

static error_t parse_render_option(int key, char *value, struct argp_state *state) {
  render_arguments *arguments = state->input;
  switch (key) {
  case 'o':
    arguments->scan = value;
    return 0;
  case 't':
    arguments->truth = value;
    return 0;
  case ARGP_KEY_ARG:
    if (arguments->spec) argp_error(state, "one SPEC.json at a time, not also '%s'", value);
    arguments->spec = value;
    return 0;
  case ARGP_KEY_END:
    if (!arguments->spec) argp_error(state, "say which SPEC.json to render");
    if (!arguments->scan) argp_error(state, "say where the scan goes: -o SCAN.png");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static fg_status render(fg_context *ctx, const render_arguments *arguments) {
  fg_render_spec *spec = NULL;
  fg_output_set outputs = {.path = {arguments->scan, arguments->truth}, .count = 2};
  const fg_input input = {arguments->spec, "the spec"};
  fg_status status = fg_output_set_check(ctx, &outputs, &input, 1);
  if (status == FG_OK) status = fg_render_load(ctx, arguments->spec, &spec);
  if (status == FG_OK) status = fg_render_scan(ctx, spec, arguments->scan, arguments->truth);
  fg_render_free(spec);
  fg_output_set_close(&outputs);
  return status;
}

const struct argp fg_render_parser = {options, parse_render_option, "SPEC.json", doc,
                                      NULL,    fg_cli_fill,         NULL};

int fg_cmd_render(int argc, char **argv) {
  render_arguments arguments = {0};
  fg_context ctx = {0};
  fg_status parsed = fg_cli_parse(&ctx, &fg_render_parser, argc, argv, &arguments);
  if (parsed != FG_OK) return fg_cli_fail(&ctx, parsed);
  fg_status status = render(&ctx, &arguments);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
