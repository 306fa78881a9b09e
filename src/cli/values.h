/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options that only keep their value: a row says where in the parser's input it goes. */
#ifndef FG_CLI_VALUES_H
#define FG_CLI_VALUES_H

#include <argp.h>
#include <stdbool.h>
#include <stddef.h>

typedef enum {
  FG_CLI_SWITCH, /* an option without a value: true */
  FG_CLI_TEXT,
  FG_CLI_REAL,
  FG_CLI_INT,
  FG_CLI_UNSIGNED,
  FG_CLI_UNSIGNED_LONG
} fg_cli_value_type;

typedef struct fg_cli_value {
  int key; /* of the option; 0 ends the rows */
  fg_cli_value_type type;
  size_t offset;          /* in the input, bytes */
  double lowest, highest; /* of a number */
} fg_cli_value;

/* The type of the value follows from that of the member. */
#define FG_CLI_TYPE(input, member)                                                                 \
  _Generic(((input *)0)->member,                                                                   \
      bool: FG_CLI_SWITCH,                                                                         \
      const char *: FG_CLI_TEXT,                                                                   \
      double: FG_CLI_REAL,                                                                         \
      int: FG_CLI_INT,                                                                             \
      unsigned: FG_CLI_UNSIGNED,                                                                   \
      unsigned long: FG_CLI_UNSIGNED_LONG)

/* Row of a text or a switch. */
#define FG_CLI_VALUE(key, input, member)                                                           \
  { key, FG_CLI_TYPE(input, member), offsetof(input, member), 0, 0 }

/* Row of a number from `lowest` to `highest`; a whole one where the member is. */
#define FG_CLI_NUMBER(key, input, member, lowest, highest)                                         \
  { key, FG_CLI_TYPE(input, member), offsetof(input, member), lowest, highest }

/* Keeps the value of an option in the parser's input; returns false where no row has its key. A
 * wrong number ends the program. */
bool fg_cli_keep_value(const fg_cli_value *values, int key, const char *text,
                       struct argp_state *state);

#endif
