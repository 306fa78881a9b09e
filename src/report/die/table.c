/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die for the terminal. */
#include <math.h>

#include "core/file.h"
#include "foilgauge/die_report.h"
#include "report/verdict_members.h"

static void write_number(FILE *out, double value, int width, int decimals, const char *sign) {
  if (isfinite(value))
    fprintf(out, sign[0] ? " %+*.*f" : " %*.*f", width, decimals, value);
  else
    fprintf(out, " %*s", width, "-");
}

static void write_die_row(FILE *out, const fg_die_value v[FG_DIE_QUANTITIES], double sd) {
  write_number(out, v[FG_DIE_RADIUS].value, 9, 5, "");
  write_number(out, 2000 * v[FG_DIE_RADIUS].u, 6, 2, "");
  write_number(out, 1000 * sd, 6, 2, "");
  write_number(out, v[FG_DIE_RADIUS_ERROR].value, 7, 3, "+");
  write_number(out, v[FG_DIE_ANGLE].value, 8, 3, "");
  write_number(out, v[FG_DIE_ANGLE_ERROR].value, 7, 3, "+");
  write_number(out, v[FG_DIE_HEIGHT].value, 8, 5, "");
  write_number(out, v[FG_DIE_CENTRE].value, 9, 5, "");
  write_number(out, v[FG_DIE_PLACE].value, 7, 3, "+");
}

static void write_side(FILE *out, const fg_die *die, const fg_die_side *side) {
  fputs("  bump    R mm   U um  sd um   e_R %  alpha dg  e_al %     h mm      X mm  place dg\n",
        out);
  for (size_t i = 0; i < side->bump_count; i++) {
    const fg_die_bump *bump = &side->bumps[i];
    fg_verdict verdict = fg_die_judge_bump(die, bump);
    fprintf(out, "  %4d", bump->number);
    write_die_row(out, bump->value, bump->value[FG_DIE_RADIUS].sd);
    fprintf(out, "%s%s\n", verdict == FG_VERDICT_NONE || verdict == FG_VERDICT_PASS ? "" : "  ",
            verdict == FG_VERDICT_NONE || verdict == FG_VERDICT_PASS ? ""
                                                                     : fg_verdict_phrase(verdict));
  }
  fputs("  mean", out);
  write_die_row(out, side->mean, side->mean[FG_DIE_RADIUS].sd);
  fprintf(out, "\n  lands: R0 = %.4f mm, U %.2f um, %+.3f %%\n", side->overall_radius_mm.value,
          2000 * side->overall_radius_mm.u, side->overall_error_pct.value);
}

static void write_half(FILE *out, const fg_die *die, fg_die_half half) {
  const fg_die_side *side = &die->half[half];
  char unseen[200];
  fprintf(out, "\n%s half (%s), %zu trace%s\n", fg_die_half_word(half),
          half == FG_DIE_CONCAVE ? "grooves; touches the strip's inner side"
                                 : "ridges; touches the strip's outer side",
          side->traces, side->traces == 1 ? "" : "s");
  write_side(out, die, side);
  if (fg_die_unseen(die, half, FG_DIE_UNTRACED, unseen, sizeof unseen))
    fprintf(out, "  not seen whole in any trace: bump %s\n", unseen);
  if (fg_die_unseen(die, half, FG_DIE_LOST, unseen, sizeof unseen))
    fprintf(out, "  traced, but lost to dust or a lost contact: bump %s\n", unseen);
}

fg_status fg_die_write_table(fg_context *ctx, const fg_die *die, FILE *out) {
  static const char *const datum_words[] = {"midline", "inner side", "outer side"};
  char words[200];
  fg_report_outcome outcome;
  fg_die_judge(die, &outcome, words, sizeof words);
  fprintf(out, "die against design %s: R %.4f mm, alpha %.3f deg, R0 %.4f mm, of the strip's %s\n",
          die->design.name, die->design.bumps.radius_mm, die->design.bumps.angle_deg,
          die->design.overall_radius_mm, datum_words[die->design.datum]);
  fprintf(out, "%s: %s\n", fg_verdict_phrase(outcome.verdict), words);
  for (int half = 0; half < FG_DIE_HALVES; half++)
    if (die->half[half].traces) write_half(out, die, (fg_die_half)half);
  if (die->half[0].traces && die->half[1].traces) {
    fputs("\nthe die: a strip between both halves has the mean of them (sd: of the two)\n", out);
    write_side(out, die, &die->whole);
  }
  fputs("\nU = 2 u; sd of a bump is that of one repeat, of the mean that of the bumps\n", out);
  return fg_stream_finish(ctx, out, "the table");
}
