/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Terminal report of the loop on scans: the content of page and JSON, in lines. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/report.h"
#include "foilgauge/scan_loop.h"
#include "report/correction_words.h"
#include "report/scan_loop/bumps.h"
#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"
#include "report/value_words.h"

static void put_channel_check(FILE *out, const fg_channel_check *channel_check) {
  if (channel_check->verdict == FG_CHANNEL_CHECK_NONE) return;
  fprintf(out, "    %s", channel_check->reason);
  if (isfinite(channel_check->p_value)) fprintf(out, " (p = %.1g)", channel_check->p_value);
  fputc('\n', out);
}

static void put_claims(FILE *out, const fg_scan_result *result) {
  for (size_t i = 0; i < result->claims; i++) {
    const fg_scan_result_claim *claim = &result->claim[i];
    if (claim->free) {
      fprintf(out, "  unattributed, over %s: %.2f um\n", claim->coordinate_name,
              claim->amplitude_um);
      continue;
    }
    fprintf(out, "  %s %s:", claim->sure ? "found" : "tied ", claim->id);
    for (size_t p = 0; p < claim->parameters; p++)
      fprintf(out, " %s %.6g +- %.2g", claim->parameter[p].name, claim->parameter[p].value,
              2 * claim->parameter[p].u);
    fputc('\n', out);
    put_channel_check(out, &claim->channel_check);
  }
}

static void put_explanations(FILE *out, const fg_scan_result *result) {
  if (!result->named) {
    fputs("The data cannot tell which it is (-o has the range of every dimension over them):\n",
          out);
    for (size_t k = 0; k < result->explanations; k++)
      fprintf(out, "  %s\n", result->explanation[k].name);
    if (result->unlisted) fprintf(out, "  and %zu more\n", result->unlisted);
  }
  for (size_t i = 0; i < result->advices; i++)
    fprintf(out, "To tell: %s.\n", result->advice[i]);
}

static void print_unclaimed(FILE *out, const fg_scan_result *result) {
  for (size_t i = 0; i < result->unclaimeds; i++) {
    const fg_scan_result_unclaimed *one = &result->unclaimed[i];
    if (one->verdict == FG_LOOP_TIED) continue; /* in an explanation */
    fprintf(out, "  %s: %s", fg_loop_verdict_word(one->verdict), one->id);
    if (isfinite(one->smallest_um))
      fprintf(out, ", would have shown from %.3g um", one->smallest_um);
    fputs(one->barred ? "; seen, and not confirmed from disc to disc\n" : "\n", out);
  }
}

static void print_noise(FILE *out, const fg_scan_noise *noise) {
  if (noise->discs) {
    fputs("noise of a row, um: white, of every disc its own:", out);
    for (size_t d = 0; d < noise->discs; d++)
      fprintf(out, " %.3g", noise->disc_um[d]);
    fputc('\n', out);
    return;
  }
  fprintf(out, "noise of a row, um: %.4g; white %.4g", noise->sd_um, noise->white_um);
  if (noise->correlation > 0)
    fprintf(out, ", shared by neighbours %.4g (%s, over %.2g mm)", noise->correlated_um,
            noise->model, noise->range_mm);
  fputc('\n', out);
}

/* Writes the values that stay as measured, and in a tie those that were corrected. */
static void put_choice(FILE *out, const char *symbol, const fg_correction_choice *choice,
                       bool tied) {
  char words[FG_CHOICE_WORDS];
  fg_choice_words(symbol, choice, true, words);
  if (words[0]) fprintf(out, "  %s\n", words);
  if (tied && choice->moved && choice->reason == FG_CORRECTION_HELPS)
    fprintf(out, "  %s moved by what all explanations agree about, +- %.2g um\n", symbol,
            2000 * choice->u_move_mm);
}

/* " R 3.37998 -> 3.33999 +- 0.00034 mm": before and after the loop, U = 2 u of the reported value.
 */
static void put_moved(FILE *out, const char *symbol, double before_mm, double after_mm,
                      double u_mm) {
  fprintf(out, " %s %.5f -> %.5f", symbol, before_mm, after_mm);
  if (isfinite(u_mm)) fprintf(out, " +- %.5f", FG_COVERAGE_FACTOR * u_mm);
  fputs(" mm", out);
}

/* ", form error 10.35 +- 0.18 um". */
static void put_form_error(FILE *out, const fg_form_error *error) {
  char words[FG_FORM_ERROR_WORDS];
  fg_form_error_words(error, "+-", words, sizeof words);
  if (words[0])
    fprintf(out, ", form error %s%s", words,
            error->u_um > 0 || error->range_um[1] > 0 ? " um" : "");
}

static void print_bump(FILE *out, const fg_bump *before, const fg_bump *after) {
  fprintf(out, "  bump %d:", before->number);
  if (!isfinite(before->radius_mm) || !isfinite(after->radius_mm)) {
    fputs(" not fitted\n", out);
    return;
  }
  put_moved(out, "R", before->radius_mm, after->radius_mm, after->u_radius_mm);
  fputc(',', out);
  put_moved(out, "h", before->height_mm, after->height_mm, after->u_height_mm);
  put_form_error(out, &after->form_error);
  fputc('\n', out);
}

static void put_foils(FILE *out, const fg_measurement *before, const fg_measurement *after,
                      bool tied) {
  for (size_t f = 0; f < before->foil_count && f < after->foil_count; f++) {
    const fg_foil *b = &before->foils[f], *a = &after->foils[f];
    if (!isfinite(b->overall.radius_mm)) {
      fprintf(out, "%s foil %d: not measured: %s\n", before->scan, b->number, b->error);
      continue;
    }
    fprintf(out, "%s foil %d:", before->scan, b->number);
    put_moved(out, "R0", b->overall.radius_mm, a->overall.radius_mm, a->overall.u_radius_mm);
    put_form_error(out, &a->overall.form_error);
    fputc('\n', out);
    for (size_t k = 0; k < b->bump_count && k < a->bump_count; k++)
      print_bump(out, &b->bumps[k], &a->bumps[k]);
    for (int k = 0; k < FG_CORRECTED; k++)
      put_choice(out, fg_corrected_symbol((fg_corrected)k), &a->choice[k], tied);
  }
  for (size_t d = 0; d < before->disc_count && d < after->disc_count; d++) {
    const fg_disc *b = &before->discs[d], *a = &after->discs[d];
    fprintf(out, "%s disc %d:", before->scan, b->number);
    put_moved(out, "D", b->diameter_mm, a->diameter_mm, a->u_diameter_mm);
    fprintf(out, ", rms %.2f -> %.2f um\n", b->rms_um, a->rms_um);
    if (d + 1 == before->disc_count) put_choice(out, "R of all discs", &a->choice, tied);
  }
}

static fg_status put_next(fg_context *ctx, FILE *out, const fg_scan_result *result) {
  char *words = NULL, *commands = NULL;
  fg_status status = fg_scan_loop_next(ctx, result, &words, &commands);
  if (status == FG_OK) fprintf(out, "next: %s\n", words);
  for (const char *line = commands; line && *line;) {
    size_t length = strcspn(line, "\n");
    fprintf(out, "  %.*s\n", (int)length, line);
    line += length + (line[length] == '\n');
  }
  free(words);
  free(commands);
  return status;
}

fg_status fg_scan_loop_write_text(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  const fg_scan_result *result = fg_scan_loop_result(loop);
  const fg_scan_report report = {.result = result};
  char *sentence = NULL;
  FG_TRY(fg_scan_loop_sentence(ctx, result, &sentence));
  fprintf(out, "%s: edge residual %.3f um before, %.3f um after; noise %.3f um\n",
          fg_loop_outcome_word(result->verdict), result->before.rms, result->after.rms,
          result->noise_floor_um);
  fg_write_wrapped(out, "  ", "  ", sentence);
  free(sentence);
  FG_TRY(put_next(ctx, out, result));
  put_claims(out, result);
  fg_text_bumps(&result->bumps, out);
  for (size_t i = 0; i < result->notes; i++)
    fprintf(out, "  %s\n", result->note[i]);
  put_explanations(out, result);
  for (size_t i = 0; i < result->scans; i++)
    put_foils(out, result->scan[i].before, result->scan[i].after, result->tied);
  fputs("not claimed:\n", out);
  print_unclaimed(out, result);
  fg_text_bumps_rejected(&result->bumps, out);
  fg_members_terminal(out, "", &fg_scan_error_members, &(fg_subject){.whole = &report},
                      fg_scan_find_error);
  print_noise(out, &result->noise);
  fputs("+- is U = 2 u.\n", out);
  return fg_stream_finish(ctx, out, "the loop's report");
}
