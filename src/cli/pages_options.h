/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of the commands that serve pages: address, names, tokens, users. */
#ifndef FG_CLI_PAGES_OPTIONS_H
#define FG_CLI_PAGES_OPTIONS_H

#include <argp.h>

#include "foilgauge/station.h"

enum { FG_CLI_HOSTS_MAX = 16, FG_CLI_TOKEN_BYTES = 256 };

enum {
  FG_CLI_PORT = 512,
  FG_CLI_LISTEN,
  FG_CLI_HOST,
  FG_CLI_ORIGIN,
  FG_CLI_TOKEN_FILE,
  FG_CLI_TOKEN,
  FG_CLI_USERS,
  FG_CLI_USER_HEADER
};

typedef struct fg_cli_pages {
  fg_station_request request;
  const char *token_file, *hosts[FG_CLI_HOSTS_MAX];
  char token[FG_CLI_TOKEN_BYTES];
} fg_cli_pages;

/* Rows of the options; `port` is the help of --port. */
#define FG_CLI_PAGES_ROWS(group, port)                                                             \
  {"port", FG_CLI_PORT, "N", 0, port, group},                                                      \
      {"listen",                                                                                   \
       FG_CLI_LISTEN,                                                                              \
       "ADDRESS",                                                                                  \
       0,                                                                                          \
       "Serve the pages to other machines, at all addresses with 0.0.0.0 or ::; needs a token "    \
       "(default: this machine alone)",                                                            \
       group},                                                                                     \
      {"host",                                                                                     \
       FG_CLI_HOST,                                                                                \
       "NAME",                                                                                     \
       0,                                                                                          \
       "Answer under this name, too (repeatable); beside the machine's own names and addresses",   \
       group},                                                                                     \
      {"origin",                                                                                   \
       FG_CLI_ORIGIN,                                                                              \
       "URL",                                                                                      \
       0,                                                                                          \
       "What browsers open where a proxy with TLS stands before the pages, as "                    \
       "https://scanner.example.com; needs a token",                                               \
       group},                                                                                     \
      {"token-file",                                                                               \
       FG_CLI_TOKEN_FILE,                                                                          \
       "FILE",                                                                                     \
       0,                                                                                          \
       "What a browser must know: the first line of FILE, at least 16 characters",                 \
       group},                                                                                     \
      {"token",                                                                                    \
       FG_CLI_TOKEN,                                                                               \
       "TEXT",                                                                                     \
       0,                                                                                          \
       "What --token-file holds, on the command line, where every user of the machine can read "   \
       "it",                                                                                       \
       group},                                                                                     \
      {"users",                                                                                    \
       FG_CLI_USERS,                                                                               \
       "FILE",                                                                                     \
       0,                                                                                          \
       "Users in place of one token, lines name,role,token: operator, quality or admin",           \
       group},                                                                                     \
  {                                                                                                \
    "user-header", FG_CLI_USER_HEADER, "NAME", 0,                                                  \
        "The proxy of --origin names the user of --users in this header, as X-Remote-User", group  \
  }

/* Reads one of these options, and checks them at the end of the command line. */
error_t fg_cli_pages_option(int key, char *text, struct argp_state *state, fg_cli_pages *pages);

/* Reads the token and fills the request; addresses go to standard output. */
fg_status fg_cli_pages_end(fg_context *ctx, fg_cli_pages *pages);

#endif
