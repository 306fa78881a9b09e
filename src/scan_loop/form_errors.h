/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Form errors of the parts by evidence. */
#ifndef FG_SCAN_LOOP_FORM_ERRORS_H
#define FG_SCAN_LOOP_FORM_ERRORS_H

#include "evidence/verdict.h"
#include "scan_loop/state.h"

/* Finds the form error of every circle of the parts (loop->form_errors): the models of the verdict,
 * or without one all of them, weighed by their evidence. */
fg_status fg_scan_loop_find_form_errors(fg_context *ctx, fg_scan_loop *loop,
                                        fg_evidence_search *search,
                                        const fg_evidence_verdict *verdict);

#endif
