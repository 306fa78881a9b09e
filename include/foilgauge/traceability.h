/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traceability: what the lengths of a report rest on.
 *
 * A scan tells lengths in pixels. A flatbed's pitch is off by up to 0.6 % along an axis, which no
 * statistics of a scan show: without anything known of the scanner the u of a length is that of its
 * edges alone, and no limit can be judged. Every report says which of three states it is in:
 *   "none"    nothing is known of the scanner: verdicts are "cannot tell", unless the design says
 *             why no calibration is needed
 *   "stated"  by a number of the user: a calibration, or gauges of known size without a certificate
 *             behind a scanner's model
 *   "plate"   by an artefact with its name, its certificate, its date and its due date */
#ifndef FOILGAUGE_TRACEABILITY_H
#define FOILGAUGE_TRACEABILITY_H

#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_traceability {
  FG_TRACED_TO_NONE,
  FG_TRACED_TO_STATED,
  FG_TRACED_TO_PLATE,
} fg_traceability;

/* "none", "stated", "plate"; NULL behind the last. */
extern const char *const fg_traceability_words[];

/* Words of a table's cell: the states, and "not needed" where limits are judged without one; NULL
 * behind the last. A cell's number. */
extern const char *const fg_traceability_cells[];
int fg_design_traceability_cell(const fg_design *design);

/* Cheapest ways to know a scanner's scale, in a sentence for people. */
extern const char fg_traceability_cure[];

fg_traceability fg_design_traceability(const fg_design *design);

/* Returns true when values may be held against limits: the scale is known, or need not be. */
bool fg_design_may_judge(const fg_design *design);

/* Returns the artefact, or a calibration's certificate and date without a name; "": not stated. */
fg_artefact fg_design_traced_to(const fg_design *design);

/* "plate GP-17, certificate DKD-K-12345 of 2026-03-14, due 2027-03-14" */
enum { FG_TRACEABILITY_SENTENCE = 400 };
void fg_traceability_sentence(const fg_design *design, char *sentence, size_t size);

/* FG_ERR_DATA when an artefact has no name or a date that is none; `member` is for the message. */
fg_status fg_artefact_check(fg_context *ctx, const char *member, const fg_artefact *artefact);

/* FG_ERR_DATA when a scan is younger than the artefact's due date. `scan_date` begins with its day,
 * "2026-11-20"; "": not known. `file` is of the model, or of the design; NULL: none. */
fg_status fg_artefact_check_due(fg_context *ctx, const char *file, const fg_artefact *artefact,
                                const char *scan_date);

#ifdef __cplusplus
}
#endif
#endif
