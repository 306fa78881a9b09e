/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checked memory, which is public. */
#ifndef FG_CORE_MEMORY_H
#define FG_CORE_MEMORY_H

#include "foilgauge/memory.h"

#endif
