/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/status.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

#include "foilgauge/version.h"

fg_status fg_fail(fg_context *ctx, fg_status status, const char *format, ...) {
  if (ctx) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(ctx->message, sizeof ctx->message, format, arguments);
    va_end(arguments);
  }
  return status;
}

fg_status fg_status_of_errno(int error) {
  return error == ENOMEM ? FG_ERR_MEMORY : FG_ERR_IO;
}

int fg_status_exit_code(fg_status status) {
  switch (status) {
  case FG_OK:
    return 0;
  case FG_ERR_USAGE:
    return 64;
  case FG_ERR_DATA:
  case FG_ERR_NUMERIC:
    return 65;
  case FG_ERR_MEMORY:
    return 71;
  case FG_ERR_IO:
    return 74;
  case FG_ERR_INTERRUPTED:
    return 130;
  case FG_ERR_NOT_MEASURED:
    return 2;
  }
  return 70;
}

const char *fg_version(void) {
  return FOILGAUGE_VERSION;
}
