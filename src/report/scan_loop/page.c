/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page of the loop on scans: the effects and their certainty; residuals of the edges; curves;
 * dimensions; effects tried. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/provenance.h"
#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"

static void put_loop_tiles(FILE *out, const fg_scan_result *result) {
  char rms[32], rms_after[32], floor[32], held_out[32], smaller[80], left[80], share[80];
  const fg_scan_loop_error *before = &result->before, *after = &result->after;
  bool corrected = result->corrected,
       apart = corrected && result->held_out != FG_SCAN_HELD_OUT_NOTHING;
  fg_scan_loop_length_words(before->rms, rms, sizeof rms);
  fg_scan_loop_length_words(after->rms, rms_after, sizeof rms_after);
  fg_scan_loop_length_words(result->noise_floor_um, floor, sizeof floor);
  fg_scan_loop_length_words(after->held_out_rms, held_out, sizeof held_out);
  fg_text_clip(smaller, sizeof smaller, "after / before = %.3g", after->rms / before->rms);
  fg_text_clip(left, sizeof left, "what is left is %.3g times this",
               after->rms / result->noise_floor_um);
  fg_text_clip(share, sizeof share, "after / before = %.3g",
               after->held_out_rms / before->held_out_rms);
  const fg_tile tiles[] = {
      {corrected ? "Edge residual before" : "Edge residual", .text = rms, .small = "rms"},
      {corrected ? "Edge residual after" : NULL, .text = rms_after, .small = "rms"},
      {corrected ? "Smaller by" : NULL, .value = before->rms / after->rms, .digits = 3, .unit = "×",
       .small = smaller},
      {"Noise floor", .text = floor, .small = left},
      {!apart          ? NULL
       : result->folds ? "Cross-fitted, after"
                       : "Scans kept aside, after",
       .text = held_out, .small = share},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_inputs(FILE *out, const fg_scan_result *result) {
  const fg_scan_report report = {.result = result};
  const fg_subject list = {.whole = &report};
  fg_member_columns columns;
  fg_subject row;
  fg_member_columns_of(&fg_scan_input_members, FG_ON_PAGE, &list, &columns);
  fg_html_table_begin(out, &columns);
  fg_html_table_rows(out);
  for (size_t i = 0; fg_list_next(&list, fg_scan_find_input, i, &row); i++) {
    fg_html_table_row(out, &columns, &row);
    fputs("</tr>\n", out);
  }
  if (result->bumps.declared_path) {
    fputs("<tr><td class=\"path\">", out);
    fg_html_text(out, result->bumps.declared_path);
    fprintf(out,
            "</td><td class=\"w\"><code>%.12s</code></td><td class=\"w\">–</td><td class=\"w\">a "
            "forming</td><td class=\"w\">declared of the bumps</td></tr>\n",
            result->bumps.declared_sha256);
  }
  fg_html_table_end(out);
  if (result->same_foil)
    fputs("<p class=\"note\">The scans show the same foil: what stays with the glass is the "
          "scanner, what turns is the part.</p>\n",
          out);
}

static void put_uncertainty(FILE *out, const fg_scan_result *result) {
  if (result->contradicted)
    fputs(
        "<p class=\"uncertain\">The scans kept aside do not confirm it: there the residual becomes "
        "larger. Do they lie at the same place of the same glass?</p>\n",
        out);
}

/* The commands, a line each. */
static void put_commands(FILE *out, const char *commands) {
  char line[2048];
  while (commands && *commands) {
    size_t length = strcspn(commands, "\n");
    fg_text_clip(line, sizeof line, "%.*s", (int)length, commands);
    fputs("<code>", out);
    fg_html_text(out, line);
    fputs("</code>", out);
    commands += length + (commands[length] == '\n');
  }
}

static fg_status put_next(fg_context *ctx, FILE *out, const fg_scan_result *result) {
  char *words = NULL, *commands = NULL;
  fg_status status = fg_scan_loop_next(ctx, result, &words, &commands);
  if (status == FG_OK) {
    fprintf(out, "<div class=\"next%s\"><b>What to do next:</b> ",
            result->verdict == FG_LOOP_CLEAN ? " calm" : "");
    fg_html_text(out, words);
    put_commands(out, commands);
    fputs("</div>\n", out);
  }
  free(words);
  free(commands);
  return status;
}

static fg_status put_loop_head(fg_context *ctx, FILE *out, const fg_scan_result *result,
                               const char *sentence) {
  static const char *const classes[] = {"clean", "explained", "partly", "unattributed", "partly"};
  fprintf(out,
          "<section><header><h1>Closing the loop</h1>%s<span class=\"verdict loop-%s\">%s</span>"
          "</header>\n<p class=\"say\">",
          result->named ? "" : "<span class=\"verdict loop-partly\">tied: not named</span>",
          classes[result->verdict], fg_loop_outcome_word(result->verdict));
  fg_html_text(out, sentence);
  fputs("</p>\n", out);
  put_uncertainty(out, result);
  FG_TRY(put_next(ctx, out, result));
  put_loop_tiles(out, result);
  put_inputs(out, result);
  fputs("</section>\n", out);
  return FG_OK;
}

/* ---- candidates ---- */

static void put_effect_name(FILE *out, const char *id, const char *words) {
  fputs("<td class=\"words\">", out);
  fg_html_text(out, words);
  fputs("<i>", out);
  fg_html_text(out, id);
  fputs("</i></td>", out);
}

/* Writes the last two columns: share of the residual that the effect alone explains, and share of
 * the effect that the geometry leaves. */
static void put_shares(FILE *out, double alone, double share, bool of_width) {
  if (isnan(alone) && isnan(share))
    fputs("<td>–</td><td>–</td></tr>\n", out);
  else
    fprintf(out, "<td>%.0f %%%s</td><td>%.*f %%</td></tr>\n", 100 * alone,
            of_width ? " of the width" : "", share < 0.1 ? 2 : 0, 100 * share);
}

static void put_channel_check(FILE *out, const fg_channel_check *channel_check) {
  if (channel_check->verdict == FG_CHANNEL_CHECK_NONE) return;
  fputs("<br><span class=\"note\">", out);
  fg_html_text(out, channel_check->reason);
  if (isfinite(channel_check->p_value)) fprintf(out, " (p = %.1g)", channel_check->p_value);
  fputs("</span>", out);
}

static void put_claim_row(FILE *out, const fg_scan_result_claim *claim) {
  char words[64];
  fputs("<tr class=\"on\">", out);
  put_effect_name(out, claim->id, claim->words);
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"w\">",
          claim->sure ? claim->free ? "open" : "found" : "tied",
          claim->free ? "unattributed" : fg_loop_verdict_word(claim->verdict));
  if (claim->parameters) {
    const fg_scan_result_parameter *p = &claim->parameter[0];
    fg_scan_loop_value_words(p->told, p->u_told, words, sizeof words);
    fprintf(out, "%s = %s %s", p->symbol, words, p->unit);
  } else {
    fputs("see its curve", out);
  }
  put_channel_check(out, &claim->channel_check);
  fputs("</td>", out);
  put_shares(out, claim->would_explain, claim->retained_share, claim->of_width);
}

static void put_unclaimed_row(FILE *out, const fg_scan_result_unclaimed *one) {
  fg_loop_verdict verdict = one->verdict;
  char words[32];
  fputs("<tr>", out);
  put_effect_name(out, one->id, one->words);
  fg_scan_loop_length_words(one->smallest_um, words, sizeof words);
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"w\">",
          verdict == FG_LOOP_TIED     ? "tied"
          : verdict == FG_LOOP_ABSENT ? "absent"
                                      : "open",
          fg_loop_verdict_word(verdict));
  if (verdict == FG_LOOP_TIED)
    fputs("could be it: see above", out);
  else
    fprintf(out, "%s%s", isfinite(one->smallest_um) ? "would have shown from " : "", words);
  fputs(one->barred ? "<br>seen, and not confirmed from disc to disc</td>" : "</td>", out);
  put_shares(out, one->would_explain, one->retained_share, one->of_width);
}

static void put_candidates(FILE *out, const fg_scan_result *result) {
  fputs("<section><h2 class=\"first\">Candidates and verdicts</h2>\n<div class=\"scroll\"><table>"
        "<thead><tr><th>effect</th><th class=\"w\">verdict</th><th class=\"w\">size, ± U = 2u</th>"
        "<th>alone it would take<br>of the residual</th><th>not absorbed<br>by the circles</th>"
        "</tr></thead>\n",
        out);
  for (size_t i = 0; i < result->claims; i++)
    put_claim_row(out, &result->claim[i]);
  for (size_t i = 0; i < result->unclaimeds; i++)
    put_unclaimed_row(out, &result->unclaimed[i]);
  fprintf(out,
          "</table></div>\n<p class=\"note\">Absent: %g µm of it would have shown. Inconclusive: "
          "the data could not have shown that much. Absorbed by geometry: circles that move and "
          "change their radius look the same. Sizes of smooth effects are what they do 18 mm from "
          "the middle.</p></section>\n",
          result->matters_um);
}

static void put_explanation(FILE *out, const fg_scan_result_explanation *one, bool likeliest) {
  fputs("<li>", out);
  fg_html_text(out, one->words);
  fprintf(out, " <code>%s</code>", one->name);
  fputs(likeliest ? " <b>(the likeliest: drawn here)</b></li>\n" : "</li>\n", out);
}

static void put_explanations(FILE *out, const fg_scan_result *result) {
  if (result->named) return;
  fputs("<section><h2 class=\"first\">What the data cannot tell apart</h2>\n", out);
  if (result->common[0]) {
    fputs("<p class=\"note\">Beside what is sure (", out);
    fg_html_text(out, result->common);
    fputs("):</p>\n", out);
  }
  fputs("<ol class=\"words\">\n", out);
  for (size_t m = 0; m < result->explanations; m++)
    put_explanation(out, &result->explanation[m], m == 0);
  fputs("</ol>\n", out);
  if (result->unlisted) fprintf(out, "<p class=\"note\">And %zu more.</p>\n", result->unlisted);
  fputs("<p class=\"note\">Each explains the residual as well as the noise and the edge model "
        "allow to say. The dimensions below carry their range over all of them; a dimension is "
        "moved only as far as that is better whichever of them is true.</p>\n",
        out);
  fputs("</section>\n", out);
}

/* Writes the first advice for a tie at the top, as the next step. */
static void put_advice(FILE *out, const fg_scan_result *result) {
  size_t first = !result->named && !result->contradicted;
  if (result->advices <= first) return;
  fputs("<section><h2 class=\"first\">To tell them apart</h2>\n<ul class=\"words\">\n", out);
  for (size_t i = first; i < result->advices; i++) {
    fputs("<li>", out);
    fg_html_text(out, result->advice[i]);
    fputs(".</li>\n", out);
  }
  fputs("</ul></section>\n", out);
}

static void put_scale(FILE *out, const fg_scan_result *result) {
  if (!result->scale_tied) return;
  fputs("<section><h2 class=\"first\">A scale that the edges cannot see</h2>\n<p class=\"note\">A "
        "distortion of the optics about another middle, beside a scale of the carriage, leaves the "
        "same edges and another size of everything. That would explain the bumps' arc length as "
        "well as the part does; the dimensions below carry their range over both.</p>"
        "</section>\n",
        out);
}

/* ---- errors ---- */

static void put_disc_noise(FILE *out, const fg_scan_noise *noise) {
  char words[2][32];
  double low = INFINITY, high = 0;
  for (size_t d = 0; d < noise->discs; d++) {
    low = fmin(low, noise->disc_um[d]);
    high = fmax(high, noise->disc_um[d]);
  }
  fg_scan_loop_length_words(low, words[0], sizeof words[0]);
  fg_scan_loop_length_words(high, words[1], sizeof words[1]);
  fprintf(out,
          "<tr><td class=\"words\">white: rows are independent, every disc has its own</td>"
          "<td>%s%s%s</td><td>–</td><td>–</td></tr>\n",
          words[0], noise->discs > 1 ? " to " : "", noise->discs > 1 ? words[1] : "");
}

static void put_edge_noise(FILE *out, const fg_scan_noise *noise) {
  char words[2][32];
  fg_scan_loop_length_words(noise->white_um, words[0], sizeof words[0]);
  fg_scan_loop_length_words(noise->correlated_um, words[1], sizeof words[1]);
  if (noise->correlation > 0)
    fprintf(out,
            "<tr><td class=\"words\">white, and %s along the edge</td><td>%s</td><td>%s</td>"
            "<td>%.2g mm</td></tr>\n",
            noise->model, words[0], words[1], noise->range_mm);
  else
    fprintf(out,
            "<tr><td class=\"words\">white: rows are independent</td><td>%s</td><td>–</td>"
            "<td>–</td></tr>\n",
            words[0]);
}

static void put_noise_words(FILE *out, const fg_scan_noise *noise) {
  fputs("<div class=\"scroll\"><table><thead><tr><th>noise of a row</th><th>white, sd</th>"
        "<th>shared by<br>neighbours, sd</th><th>over</th></tr></thead>\n",
        out);
  (noise->discs ? put_disc_noise : put_edge_noise)(out, noise);
  fputs("</table></div>\n", out);
}

static void put_held_out(FILE *out, const fg_scan_result *result) {
  if (result->held_out == FG_SCAN_HELD_OUT_SCANS) return;
  fputs("<p class=\"note\">No scan was kept aside (<code>--hold-out</code>)", out);
  if (result->folds)
    fprintf(out,
            ", so the %s went round %zu folds: without each the search was repeated, and what it "
            "found then was taken out of it. The geometry is fitted to all rows, before and after",
            result->fold_of, result->folds);
  else if (result->corrected)
    fprintf(out, ", and the %s are too few to search without some of them",
            result->discs ? "discs" : "bumps");
  fputs(".</p>\n", out);
}

static void put_error_table(FILE *out, const fg_scan_result *result) {
  const fg_scan_report report = {.result = result};
  size_t left_out = 0;
  char words[32];
  for (size_t i = 0; i < result->rows; i++)
    left_out += !(result->row[i].weight > 0);
  fputs("<section><h2 class=\"first\">Errors of the edge rows</h2>\n", out);
  fg_html_table(out, &fg_scan_error_members, &(fg_subject){.whole = &report}, fg_scan_find_error);
  fg_scan_loop_length_words(result->noise_floor_um, words, sizeof words);
  fprintf(out,
          "<p class=\"note\">%zu rows, each the mean of %zu neighbours along the "
          "strip; %zu of them left out as outliers. Noise floor of a row: %s; after / noise floor "
          "= %.3g.",
          result->rows, result->row_stations, left_out, words,
          result->after.rms / result->noise_floor_um);
  fputs("</p>\n", out);
  put_held_out(out, result);
  put_noise_words(out, &result->noise);
  fputs("</section>\n", out);
}

static fg_status put_model_origin(fg_context *ctx, FILE *out, const fg_scan_result *result) {
  fg_provenance from = {.design = &result->scan[0].before->design, .of_scans = true};
  for (size_t i = 0; i < result->scans; i++)
    fg_provenance_include_date(&from, result->scan[i].before->date);
  return fg_html_provenance_section(ctx, out, &from);
}

fg_status fg_scan_loop_write_html(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  const fg_scan_result *result = fg_scan_loop_result(loop);
  char *sentence = NULL;
  FG_TRY(fg_scan_loop_sentence(ctx, result, &sentence));
  fg_html_begin(out, "Closing the loop");
  fg_status status = put_loop_head(ctx, out, result, sentence);
  free(sentence);
  FG_TRY(status);
  put_explanations(out, result);
  put_scale(out, result);
  put_advice(out, result);
  FG_TRY(fg_scan_loop_page_vectors(ctx, out, result));
  fg_scan_loop_page_effects(out, result);
  FG_TRY(fg_scan_loop_page_residuals(ctx, out, result));
  fg_scan_loop_page_dimensions(out, result);
  fg_scan_loop_page_bumps(out, result);
  put_candidates(out, result);
  put_error_table(out, result);
  FG_TRY(put_model_origin(ctx, out, result));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the loop's page");
}
