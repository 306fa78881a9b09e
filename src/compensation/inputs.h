/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs of a next die: target, an earlier report, lots with their dies. */
#ifndef FG_COMPENSATION_INPUTS_H
#define FG_COMPENSATION_INPUTS_H

#include "compensation/members.h"
#include "compensation/sets.h"

typedef struct fg_compensation_inputs {
  fg_formed_sets sets;       /* those of the earlier report first */
  fg_die_dimensions present; /* of the last set */
  size_t bumps;              /* of the target */
  bool has_prior;            /* an earlier report was read: `present` is its die at first */
} fg_compensation_inputs;

/* Reads the sets of an earlier report, of `die --target` or of `lot --expected`. */
fg_status fg_prior_read(fg_context *ctx, const char *path, fg_formed_sets *sets);

/* FG_ERR_DATA: the lot is of another kind of foil, strip or datum than the target. */
fg_status fg_compensation_check_lot(fg_context *ctx, const char *folder, const fg_design *lot,
                                    const fg_design *target);

/* Fills target and files of `next`, and the inputs. */
fg_status fg_compensation_inputs_read(fg_context *ctx, const fg_compensation_request *request,
                                      fg_next_die *next, fg_compensation_inputs *inputs);

/* Adds a note of a result. */
void fg_next_die_note(fg_next_die *next, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
