/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rivals with a shape: what a named effect beside others may be in truth.
 *
 * A sawtooth over one jump is a step with a slope, a chip that is mounted askew a step with two:
 * sets of named effects explain them on one arc, and are no evidence for their names. A decay of
 * x, or a wave of it, is as likely as the carriage's start and its ripple, which have names. A wave
 * whose size changes is three waves of one size to them, a stop that settles steps with dents
 * beside them: sets of pieces, for one cause. A burr of one disc is lost rows and seams that cross
 * it alone. */
#ifndef FG_EVIDENCE_UNNAMED_H
#define FG_EVIDENCE_UNNAMED_H

#include "effect/effect.h"

/* The rows, in the form of effects, which no report names; NULL-terminated by id. */
enum { FG_UNNAMED_EFFECTS = 26 };
extern const fg_effect fg_unnamed_effects[FG_UNNAMED_EFFECTS + 1];

/* Returns false on discs for lines that are broken along their own way: there a slope and a jump
 * are seen apart, and both have names. Tilted chips break them across it, which no name has. */
bool fg_unnamed_shows(const fg_effect *effect, const fg_edge_fit *edge_fit);

/* Returns true for a pulse or a spot: on one arc a dent is as likely, which discs have as a form.
 */
bool fg_unnamed_is_of_one_place(const fg_effect *effect);

/* Returns the number of rows of its kind, which share one prior probability: faults at one place of
 * the picture are a kind, the others are one. */
size_t fg_unnamed_of_kind(const fg_effect *effect);

/* False for one of those that nobody has named, and for NULL: a rival has no effect. */
bool fg_effect_bears_name(const fg_effect *effect);

#endif
