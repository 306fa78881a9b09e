/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a spec, from JSON to requests. */
#ifndef FG_RENDER_PARSE_H
#define FG_RENDER_PARSE_H

#include "render/spec.h"

/* Rows of a table of members: members of a struct under their own names. */
#define FG_SPEC_NUMBER(type, member, low, high)                                                    \
  { #member, FG_SPEC_NUMBER, offsetof(type, member), low, high }
#define FG_SPEC_INTEGER(type, member, low, high)                                                   \
  { #member, FG_SPEC_INTEGER, offsetof(type, member), low, high }
#define FG_SPEC_OTHER(name)                                                                        \
  { name, FG_SPEC_OTHER, 0, 0, 0 }
#define FG_SPEC_END                                                                                \
  { NULL, FG_SPEC_END, 0, 0, 0 }

/* Returns the member, or NULL. */
static inline const cJSON *fg_spec_member(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* The Gen II design of thesis table 5.6, with the lip and end lands of the fixture. */
fg_foil_request fg_spec_default_foil(void);
fg_status fg_spec_read_foils(const fg_place *place, const cJSON *array, fg_render_spec *spec);
fg_status fg_spec_read_beams(const fg_place *place, const cJSON *foil, fg_foil_request *request);
fg_status fg_spec_read_grids(const fg_place *place, const cJSON *array, fg_render_spec *spec);
fg_status fg_spec_read_discs(const fg_place *place, const cJSON *array, fg_render_spec *spec);

fg_scanner fg_spec_default_scanner(void);
fg_status fg_spec_read_scanner(const fg_place *place, const cJSON *object, fg_scanner *scanner);

#endif
