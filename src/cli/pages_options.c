/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/pages_options.h"

#include <stdio.h>

#include "cli/commands.h"
#include "foilgauge/file.h"

static void check_pages_options(const fg_cli_pages *pages, struct argp_state *state) {
  const fg_station_request *request = &pages->request;
  if (request->token && pages->token_file)
    argp_error(state, "--token and --token-file: one of them");
  if (request->users && (request->token || pages->token_file))
    argp_error(state, "--users: users have tokens of their own, beside them there is no --token");
  if (request->user_header && !(request->users && request->origin))
    argp_error(state, "--user-header: needs --users, and the --origin of the proxy");
}

error_t fg_cli_pages_option(int key, char *text, struct argp_state *state, fg_cli_pages *pages) {
  fg_station_request *request = &pages->request;
  switch (key) {
  case FG_CLI_PORT:
    request->port = (unsigned)fg_cli_number(state, "port", text, 0, 65535);
    break;
  case FG_CLI_LISTEN:
    request->listen = text;
    break;
  case FG_CLI_HOST:
    if (request->host_count == FG_CLI_HOSTS_MAX)
      argp_error(state, "--host: at most %d names", FG_CLI_HOSTS_MAX);
    pages->hosts[request->host_count++] = text;
    break;
  case FG_CLI_ORIGIN:
    request->origin = text;
    break;
  case FG_CLI_TOKEN_FILE:
    pages->token_file = text;
    break;
  case FG_CLI_TOKEN:
    request->token = text;
    break;
  case FG_CLI_USERS:
    request->users = text;
    break;
  case FG_CLI_USER_HEADER:
    request->user_header = text;
    break;
  case ARGP_KEY_END:
    check_pages_options(pages, state);
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static void print_address(void *user, const char *address) {
  (void)user;
  printf("%s\n", address);
  fflush(stdout);
}

fg_status fg_cli_pages_end(fg_context *ctx, fg_cli_pages *pages) {
  fg_station_request *request = &pages->request;
  if (pages->token_file)
    FG_TRY(fg_file_read_token(ctx, pages->token_file, pages->token, FG_CLI_TOKEN_BYTES));
  if (pages->token_file) request->token = pages->token;
  request->hosts = pages->hosts;
  request->ready = print_address;
  return FG_OK;
}
