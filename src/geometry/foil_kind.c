/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/foil_kind.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/stiffness.h"
#include "foilgauge/words.h"

static const fg_foil_row *const kinds[] = {
    [FG_FOIL_CLASSICAL] = &fg_foil_kind_classical,
    [FG_FOIL_SINUSOIDAL] = &fg_foil_kind_sinusoidal,
    [FG_FOIL_DISCS] = &fg_foil_kind_discs,
    [FG_FOIL_ARC] = &fg_foil_kind_arc,
    [FG_FOIL_CANTILEVER] = &fg_foil_kind_cantilever,
    [FG_FOIL_GRID] = &fg_foil_kind_grid,
};
static_assert(sizeof kinds / sizeof *kinds == FG_FOIL_KINDS, "every kind of foil has a row");

const fg_foil_row *fg_foil_row_of(fg_foil_kind kind) {
  return kinds[kind];
}

const fg_foil_traits *fg_foil_traits_of(fg_foil_kind kind) {
  return &kinds[kind]->traits;
}

size_t fg_design_stated_parts(const fg_design *design) {
  const fg_foil_row *kind = fg_foil_row_of(design->kind);
  return kind->stated_parts ? kind->stated_parts(design) : 0;
}

bool fg_foil_kind_has_bumps(fg_foil_kind kind) {
  return kinds[kind]->traits.has_bumps;
}

const char *fg_stiffness_kind_note(fg_foil_kind kind) {
  return kinds[kind]->traits.stiffness_note;
}

const char *fg_foil_kind_word(fg_foil_kind kind) {
  return kinds[kind]->traits.name;
}

bool fg_foil_kind_find(const char *name, fg_foil_kind *kind) {
  for (int i = 0; i < FG_FOIL_KINDS; i++)
    if (!strcmp(name, kinds[i]->traits.name)) {
      *kind = (fg_foil_kind)i;
      return true;
    }
  return false;
}

void fg_foil_kind_list(bool built_in, const char *quote, const char *last, char *text,
                       size_t size) {
  int count = 0, named = 0;
  for (int i = 0; i < FG_FOIL_KINDS; i++)
    count += !built_in || kinds[i]->traits.built_in;
  text[0] = 0;
  for (int i = 0; i < FG_FOIL_KINDS; i++) {
    if (built_in && !kinds[i]->traits.built_in) continue;
    size_t used = strlen(text);
    const char *joint = !named ? "" : named + 1 < count ? ", " : last;
    fg_text_clip(text + used, size - used, "%s%s%s%s", joint, quote, kinds[i]->traits.name, quote);
    named++;
  }
}
