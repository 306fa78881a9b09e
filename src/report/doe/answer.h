/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first part of an experiment's page. */
#ifndef FG_REPORT_DOE_ANSWER_H
#define FG_REPORT_DOE_ANSWER_H

#include <stdio.h>

#include "report/doe/words.h"

void fg_doe_put_answer(FILE *out, const fg_experiment *experiment, const fg_sentences *conclusions);
/* Writes the conclusions that the answer does not hold. */
void fg_doe_put_conclusions(FILE *out, const fg_sentences *conclusions);

#endif
