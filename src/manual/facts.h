/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts for the manual alone (cli/facts.h has those of --help too): tables of the members that
 * the code reads and writes. */
#ifndef FG_MANUAL_FACTS_H
#define FG_MANUAL_FACTS_H

#include "cli/facts.h"

const fg_fact *fg_manual_fact(const char *name, size_t length);

#endif
