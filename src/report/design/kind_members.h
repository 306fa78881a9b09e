/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a design that one group of kinds has: the row's `present` tells the group. */
#ifndef FG_REPORT_DESIGN_KIND_MEMBERS_H
#define FG_REPORT_DESIGN_KIND_MEMBERS_H

#include "core/member.h"

/* True for a design (the subject's object) with dimensions of this group. A member of the group has
 * one of them as `present`; so the reader knows into which group of dimensions it goes, as the
 * member `form` may come last. */
bool fg_design_is_of_bumps(const fg_subject *subject);
bool fg_design_is_of_beams(const fg_subject *subject);
bool fg_design_is_of_discs(const fg_subject *subject);
bool fg_design_is_of_arc(const fg_subject *subject);
bool fg_design_is_of_grid(const fg_subject *subject);

#endif
