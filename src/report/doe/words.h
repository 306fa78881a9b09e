/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conclusions of an experiment in plain words; the same on the terminal, the page and in JSON. */
#ifndef FG_REPORT_DOE_WORDS_H
#define FG_REPORT_DOE_WORDS_H

#include "foilgauge/experiment.h"

/* Sentences from `setting` up to `trust`: the best setting and its response. The `trusts` sentences
 * from `trust` on: reasons for and against trust in it. The page shows the former as a panel of its
 * own; all others are the same everywhere. */
typedef struct fg_sentences {
  char **text;
  size_t count, capacity;
  size_t setting, trust, trusts;
} fg_sentences;

/* Free with fg_sentences_free. */
fg_status fg_experiment_conclusions(fg_context *ctx, const fg_experiment_report *report,
                                    fg_sentences *sentences);
void fg_sentences_free(fg_sentences *sentences);
fg_status fg_sentences_add(fg_context *ctx, fg_sentences *sentences, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* True when a sentence is a command, to be shown as it is typed. */
bool fg_sentence_is_command(const char *text);

/* Add parts of the conclusions: effects taken out before the analysis; effects over the order. */
fg_status fg_experiment_conclude_subtracted(fg_context *ctx, const fg_experiment_report *report,
                                            fg_sentences *sentences);
fg_status fg_experiment_conclude_order(fg_context *ctx, const fg_experiment_report *report,
                                       fg_sentences *sentences);

fg_status fg_experiment_conclude_best(fg_context *ctx, const fg_experiment *experiment,
                                      fg_sentences *sentences);
fg_status fg_experiment_conclude_stationary(fg_context *ctx, const fg_experiment *experiment,
                                            fg_sentences *sentences);
fg_status fg_experiment_conclude_lack(fg_context *ctx, const fg_experiment *experiment,
                                      fg_sentences *sentences);

fg_status fg_experiment_conclude_asked(fg_context *ctx, const fg_experiment *experiment,
                                       fg_sentences *sentences);

/* Adds what the blocks do to every expected response. */
fg_status fg_experiment_conclude_blocks(fg_context *ctx, const fg_experiment *experiment,
                                        fg_sentences *sentences);

/* Writes the levels that an effect of a numeric factor is of, where the model lets it differ
 * between levels of words: " (at die A)"; empty: of all. */
void fg_experiment_reference_words(const fg_experiment *experiment, size_t variable, char *text,
                                   size_t size);

/* Returns the command of the loop on tables for the same data and model. The caller frees it. */
fg_status fg_experiment_loop_command(fg_context *ctx, const fg_experiment_report *report,
                                     char **command);

/* Names the response as it is modelled: "the magnitude of ...". The caller frees it. */
fg_status fg_experiment_response_words(fg_context *ctx, const fg_experiment *experiment,
                                       char **words);

/* Writes the best setting, a point of the surface, in words: "temperature 600 °C, duration 3 h,
 * pressure any (cheapest will do)". x is not read where no factor can be told from noise. */
void fg_experiment_setting_words(const fg_experiment *experiment, const double *x, char *text,
                                 size_t size);

const char *fg_surface_kind_word(fg_surface_kind kind);
const char *fg_goal_word(fg_goal goal);

/* "0.0037", "< 0.0001", "–". */
void fg_p_value_text(char text[16], double p_value);

#endif
