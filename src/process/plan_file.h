/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The companion file of a run sheet as a document. */
#ifndef FG_PROCESS_PLAN_FILE_H
#define FG_PROCESS_PLAN_FILE_H

#include "core/member.h"

extern const fg_document fg_plan_document;

#endif
