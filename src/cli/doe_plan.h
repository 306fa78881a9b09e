/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foilgauge doe plan: writes a run sheet. */
#ifndef FG_CLI_DOE_PLAN_H
#define FG_CLI_DOE_PLAN_H

#include "cli/commands.h"

fg_command_run fg_cmd_doe_plan;

#endif
