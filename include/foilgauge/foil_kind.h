/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds of foil: what each is called, has and cannot do. One row per kind; code that depends on the
 * kind asks the row. How a kind is measured is a row of src/geometry/foil_kind.h, how it is shown
 * one of src/report/measure/foil_view.h.
 */
#ifndef FOILGAUGE_FOIL_KIND_H
#define FOILGAUGE_FOIL_KIND_H

#include "foilgauge/design.h"
#include "foilgauge/quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The member of a design's union, as a bit of fg_foil_traits.refused. */
typedef enum fg_design_group {
  FG_DESIGN_COMMON, /* stated beside the union */
  FG_DESIGN_BUMPS,
  FG_DESIGN_BEAMS,
  FG_DESIGN_DISCS,
  FG_DESIGN_ARC,
  FG_DESIGN_GRID,
} fg_design_group;

enum { FG_DESIGN_GROUPS = FG_DESIGN_GRID + 1 };

enum { FG_KIND_NEEDED_MAX = 4, FG_KIND_FOREIGN_MAX = 12 };

typedef struct fg_foil_traits {
  const char *name;      /* "arc": `form` in JSON, --form on the command line */
  const char *noun;      /* "an arc" */
  fg_design_group group; /* of its dimensions */
  unsigned refused;      /* bits of the groups that its design must not state */
  bool built_in;         /* it has a design of its own without a file */
  /* Members that a design's file must state, and those that it must not. Without them the
   * dimensions have defaults. */
  const char *needed[FG_KIND_NEEDED_MAX], *foreign[FG_KIND_FOREIGN_MAX];
  const char *why_no_thickness_measured; /* the message begins with the member's name */
  const char *why_no_gauges;
  const char *why_no_loop; /* the loop on scans does not take it: after the design's path */
  const char *why_no_model;
  const char *why_no_station;
  const char *why_no_forming;
  const char *stiffness_note; /* how far the model of a bump's stiffness holds; NULL: it does */
  bool is_foil;               /* else round features or marks, without foils */
  bool is_grid;               /* marks on a lattice */
  bool has_bumps, has_lip;    /* a lip at one end */
  bool is_plain_strip;        /* one circle from end to end, without numbered parts */
  bool lies_flat; /* its rims are several islands of the scan, and its thickness is not seen */
  fg_quantity_owner part;              /* owner of the quantities of its numbered parts */
  unsigned owners;                     /* bits of the owners whose quantities it reports */
  unsigned foil_uses;                  /* uses that a foil's quantity must have, all of them */
  unsigned foil_not;                   /* uses that keep it out */
  const char *plural, *own_quantities; /* without parts: "plain strips", values that foils have */
  const char *parts_file;              /* a lot's table of parts */
  const char *ranked_by; /* a lot's quantity of foils that ranks them; NULL: that of parts does */
} fg_foil_traits;

const fg_foil_traits *fg_foil_traits_of(fg_foil_kind kind);

/* Makes a design with bumps that of its lands alone: an arc of the same overall circle. */
void fg_design_become_lands(double subtended_angle_deg, fg_design *design);

/* Returns how many numbered parts the design states; 0 when it states none or its kind has none. */
size_t fg_design_stated_parts(const fg_design *design);

/* The kind of a name. False: no kind has it. */
bool fg_foil_kind_find(const char *name, fg_foil_kind *kind);

/* "classical", "sinusoidal" or "discs": the names of all kinds, or of those with a built-in design,
 * between `quote`s, with `last` before the last of them. */
void fg_foil_kind_list(bool built_in, const char *quote, const char *last, char *text, size_t size);

/* Checks what designs of every kind state: tolerances, calibration, a measured thickness, gauges.
 */
fg_status fg_design_check_common(fg_context *ctx, const fg_design *design);

/* Defaults of a group's members. */
void fg_design_group_default(fg_design_group group, fg_design_values *values);

/* FG_ERR_DATA when a group that this kind refuses has a member that is stated, that is not 0. */
fg_status fg_design_check_refused(fg_context *ctx, fg_foil_kind kind, fg_design_group group,
                                  const fg_design_values *values);

#ifdef __cplusplus
}
#endif
#endif
