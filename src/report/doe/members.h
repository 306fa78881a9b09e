/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of an experiment's report. */
#ifndef FG_REPORT_DOE_MEMBERS_H
#define FG_REPORT_DOE_MEMBERS_H

#include "core/member.h"
#include "report/doe/words.h"

/* The whole of every subject: the experiment with its derived parts. */
typedef struct fg_doe_whole {
  const fg_experiment_report *report;
  const fg_experiment *e;    /* of the report */
  const fg_experiment *best; /* its model has the best setting */
  const fg_sentences *conclusions;
  char *command;         /* of the loop on tables, where the order shows something; or NULL */
  fg_anova_row model;    /* all terms together */
  fg_anova_row error[4]; /* residual, lack of fit, pure error, total */
} fg_doe_whole;

void fg_doe_whole_of(const fg_experiment_report *report, const fg_sentences *conclusions,
                     fg_doe_whole *whole);

static inline const fg_doe_whole *fg_doe_whole_at(const fg_subject *subject) {
  return subject->whole;
}

static inline const fg_experiment *fg_doe_experiment_at(const fg_subject *subject) {
  return fg_doe_whole_at(subject)->e;
}

/* Of the coefficients' table on page and terminal, too; an element is an fg_experiment_effect with
 * the column's index. */
extern const fg_members fg_doe_coefficient_members;
fg_member_element fg_doe_coefficient_at;

/* Analysis of variance, fit and tests; order of the runs, surface, settings and runs. */
extern const fg_members fg_doe_analysis_members, fg_doe_result_members;

/* "runs", "whole plots". */
extern const char *const fg_doe_stratum_words[];

/* Limits of a p value. */
#define FG_P_VALUE .highest = 1

extern const fg_document fg_doe_document;

#endif
