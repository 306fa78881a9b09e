/* The loop on scans for a terminal: what the page and the JSON say, in lines. */
#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "report/scan_loop/scan_loop_bumps.h"
#include "report/scan_loop/scan_loop_parts.h"

static void put_effects(FILE *out, const fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_effect_found *effect = &loop->set.effects[i];
    const char *name;
    double value, u;
    if (fg_effect_is_free(effect->kind)) {
      fprintf(out, "  unattributed, over %s: %.2f um\n",
              fg_effect_coordinate_name(effect->kind->coordinate),
              fg_effect_found_amplitude(effect));
      continue;
    }
    fprintf(out, "  %s %s:", loop->decided.sure[i] ? "found" : "tied ", effect->kind->id);
    for (size_t p = 0; fg_effect_found_number(effect, p, &name, &value, &u); p++)
      fprintf(out, " %s %.6g +- %.2g", name, value, 2 * u);
    fputc('\n', out);
  }
}

static void put_class(FILE *out, const fg_scan_loop *loop) {
  const fg_scan_loop_decisions *decided = &loop->decided;
  char name[FG_SCAN_LOOP_CLASS_WORDS];
  if (decided->shown_count > 1) {
    fputs("The data cannot tell which it is (-o has the range of every dimension over them):\n",
          out);
    for (size_t k = 0; k < decided->shown_count; k++) {
      fg_scan_loop_explanation_name(&loop->explanations, decided->shown[k], name, sizeof name);
      fprintf(out, "  %s\n", name);
    }
    if (decided->unlisted) fprintf(out, "  and %zu more\n", decided->unlisted);
  }
  for (size_t i = 0; i < decided->advices; i++)
    fprintf(out, "To tell: %s.\n", decided->advice[i]);
}

static void put_candidates(FILE *out, const fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->decided.candidates; i++) {
    const fg_scan_loop_unclaimed *candidate = &loop->decided.candidate[i];
    if (candidate->verdict == FG_LOOP_TIED) continue; /* in the class */
    fprintf(out, "  %s: %s", fg_loop_verdict_word(candidate->verdict), candidate->kind->id);
    if (isfinite(candidate->smallest_um))
      fprintf(out, ", would have shown from %.3g um", candidate->smallest_um);
    fputs(candidate->barred ? "; seen, and not confirmed from disc to disc\n" : "\n", out);
  }
}

static void put_error(FILE *out, const char *name, double before, double after) {
  if (isfinite(before)) fprintf(out, "  %-22s %10.4g %10.4g\n", name, before, after);
}

static void put_errors(FILE *out, const fg_scan_loop *loop) {
  const fg_scan_loop_error *b = &loop->error_before, *a = &loop->error_after;
  fputs("errors of the edge rows, um   before      after\n", out);
  put_error(out, "rms", b->rms, a->rms);
  put_error(out, "robust sd", b->robust_sd, a->robust_sd);
  put_error(out, "95th percentile", b->p95, a->p95);
  put_error(out, "maximum", b->maximum, a->maximum);
  put_error(out, "scans kept aside, rms", b->held_out_rms, a->held_out_rms);
}

static void put_foils(FILE *out, const fg_measurement *before, const fg_measurement *after) {
  for (size_t f = 0; f < before->foil_count && f < after->foil_count; f++) {
    const fg_foil *b = &before->foils[f], *a = &after->foils[f];
    fprintf(out, "%s foil %d: R0 %.5f -> %.5f mm\n", before->scan, b->number, b->overall.radius_mm,
            a->overall.radius_mm);
    for (size_t k = 0; k < b->bump_count && k < a->bump_count; k++)
      fprintf(out, "  bump %d: R %.5f -> %.5f mm, h %.5f -> %.5f mm\n", b->bumps[k].number,
              b->bumps[k].radius_mm, a->bumps[k].radius_mm, b->bumps[k].height_mm,
              a->bumps[k].height_mm);
  }
  for (size_t d = 0; d < before->disc_count && d < after->disc_count; d++) {
    const fg_disc *b = &before->discs[d], *a = &after->discs[d];
    fprintf(out, "%s disc %d: D %.5f -> %.5f mm, rms %.2f -> %.2f um\n", before->scan, b->number,
            b->diameter_mm, a->diameter_mm, b->rms_um, a->rms_um);
  }
}

fg_status fg_scan_loop_write_text(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  fprintf(out, "%s: edge residual %.3f um before, %.3f um after; noise %.3f um\n",
          fg_loop_outcome_word(loop->verdict), loop->error_before.rms, loop->error_after.rms,
          loop->noise_floor_um);
  put_effects(out, loop);
  fg_text_bumps(&loop->bumps, out);
  put_class(out, loop);
  for (size_t i = 0; i < loop->scan_count; i++)
    put_foils(out, &loop->before[i], &loop->after[i]);
  fputs("not claimed:\n", out);
  put_candidates(out, loop);
  fg_text_bumps_rejected(&loop->bumps, out);
  put_errors(out, loop);
  fputs("+- is U = 2 u.\n", out);
  return fg_stream_finish(ctx, out, "the loop's report");
}
