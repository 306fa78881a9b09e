/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/values.h"

#include <math.h>
#include <stdio.h>

#include "cli/commands.h"

static const struct argp_option *find_option(const struct argp *parser, int key) {
  for (const struct argp_option *option = parser->options; option && (option->name || option->doc);
       option++)
    if (option->key == key) return option;
  for (const struct argp_child *child = parser->children; child && child->argp; child++) {
    const struct argp_option *option = find_option(child->argp, key);
    if (option) return option;
  }
  return NULL;
}

static double read_number(const fg_cli_value *value, const char *text, struct argp_state *state) {
  const struct argp_option *option = find_option(state->root_argp, value->key);
  char name[64]; /* with the argument's word, which may be its unit */
  snprintf(name, sizeof name, "%s %s", option->name, option->arg);
  double number = fg_cli_number(state, name, text, value->lowest, value->highest);
  if (value->type != FG_CLI_REAL && number != floor(number))
    argp_error(state, "--%s: '%s' is no whole number", name, text);
  return number;
}

static void keep_at_place(const fg_cli_value *value, const char *text, struct argp_state *state) {
  void *place = (char *)state->input + value->offset;
  switch (value->type) {
  case FG_CLI_SWITCH:
    *(bool *)place = true;
    break;
  case FG_CLI_TEXT:
    *(const char **)place = text;
    break;
  case FG_CLI_REAL:
    *(double *)place = read_number(value, text, state);
    break;
  case FG_CLI_INT:
    *(int *)place = (int)read_number(value, text, state);
    break;
  case FG_CLI_UNSIGNED:
    *(unsigned *)place = (unsigned)read_number(value, text, state);
    break;
  case FG_CLI_UNSIGNED_LONG:
    *(unsigned long *)place = (unsigned long)read_number(value, text, state);
    break;
  }
}

bool fg_cli_keep_value(const fg_cli_value *values, int key, const char *text,
                       struct argp_state *state) {
  for (; values->key; values++) {
    if (values->key != key) continue;
    keep_at_place(values, text, state);
    return true;
  }
  return false;
}
