/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a strip's material, as its file and the reports of forming have them. */
#ifndef FG_FORMING_MATERIAL_MEMBERS_H
#define FG_FORMING_MATERIAL_MEMBERS_H

#include "core/member.h"
#include "foilgauge/forming.h"

#define FG_FORMING_MATERIAL_SCHEMA "foilgauge/material/1"

/* Of fg_forming_material. */
extern const fg_members fg_forming_material_members;

#endif
