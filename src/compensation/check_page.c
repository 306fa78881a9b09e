/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page of a lot against its prediction; both of its files. */
#include <math.h>
#include <stdlib.h>

#include "compensation/members.h"
#include "core/file.h"
#include "foilgauge/file.h"
#include "lot/run/lot.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "page/table.h"
#include "page/tile.h"
#include "report/provenance.h"

static void put_check_tiles(FILE *out, const fg_expected_check *check) {
  const fg_iteration *last = &check->iteration[check->iterations - 1];
  bool before = check->iterations > 1;
  const fg_tile tiles[] = {
      {before ? "Error before, rms" : NULL, .value = before ? last[-1].rms_error_pct : NAN,
       .decimals = 3, .unit = "%"},
      {"Error after, rms", .value = last->rms_error_pct, .decimals = 3, .unit = "%"},
      {"Values inside their intervals", .value = (double)check->inside},
      {"of", .value = (double)check->of},
      {"Lots as far off", .value = 100 * check->p_value, .digits = 2, .unit = "%",
       .look = check->p_value < 0.01 ? FG_TILE_BAD : FG_TILE_PLAIN},
  };
  fg_html_tiles(out, "tiles", tiles, sizeof tiles / sizeof *tiles);
}

static void put_held_radii(FILE *out, const fg_expected_check *check) {
  double range[2] = {INFINITY, -INFINITY}, x[2] = {0.4, (double)check->bumps + 0.6};
  for (size_t i = 0; i < check->bumps; i++) {
    fg_range_add(range, check->bump[i].radius_mm.low, 0);
    fg_range_add(range, check->bump[i].radius_mm.high, 0);
    fg_range_add(range, check->bump[i].radius_mm.measured, 0);
  }
  fg_range_pad(range, 0.08, 0.001);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Radius of every bump, measured and predicted", .height = 300,
                            .left = 80, .top = 34, .x = x, .y = range, .y_title = "bump radius, mm",
                            .ticks = FG_TICKS_OWN});
  fg_plot_level(&at, check->next.target.bumps.radius_mm, "land");
  for (size_t i = 0; i < check->bumps; i++) {
    const fg_expected_held *held = &check->bump[i].radius_mm;
    fg_plot_x_number(&at, check->bump[i].number);
    fg_plot_interval(&at, check->bump[i].number, -7, 0.5 * (held->low + held->high),
                     0.5 * (held->high - held->low), "s2");
    if (isfinite(held->measured))
      fg_plot_shape(&at, check->bump[i].number, held->measured, 5, FG_SHAPE_DIAMOND,
                    held->inside ? "s1" : "s5");
  }
  fg_plot_x_title(&at, "bump");
  fg_plot_key(&at, 90, "s2", "predicted mean, 95 %");
  fg_plot_key(&at, 330, "s1", "measured mean");
  fg_plot_end(&at);
}

/* Springback of all bumps, before and after, with the scatter between lots. */
static void put_law_change(FILE *out, const fg_expected_check *check) {
  fputs("<ul class=\"words\">\n", out);
  for (int q = 0; q < FG_FORMED; q++) {
    const fg_formed_law *before = &check->before[q], *after = &check->next.law->of[q];
    if (!check->bumps && q != FG_FORMED_OVERALL) continue;
    fprintf(out,
            "<li>Springback of the %s: %.3f ± %.3f %% before, %.3f ± %.3f %% with this lot.</li>\n",
            fg_formed_words((fg_formed)q), before->springback_pct, 2 * before->u_springback_pct,
            after->springback_pct, 2 * after->u_springback_pct);
  }
  fputs("</ul>\n<p class=\"note\">± U = 2 u. The posterior is the next prior: `foilgauge die "
        "--prior expected.json` goes on from here.</p>\n",
        out);
}

static void put_check_first(FILE *out, const fg_expected_check *check, const fg_subject *list) {
  char sentence[FG_MEMBER_TEXT_MAX];
  fg_expected_check_sentence(check, sentence, sizeof sentence);
  fputs("<section class=\"part\">\n<header><h1>Was the prediction right?</h1></header>\n"
        "<ul class=\"words\"><li>",
        out);
  fg_html_text(out, sentence);
  if (check->loop_sentence[0]) {
    fputs("</li>\n<li>Springback of all lots, against the law without single bumps: ", out);
    fg_html_text(out, check->loop_sentence);
  }
  fputs("</li></ul>\n", out);
  put_check_tiles(out, check);
  fg_html_table(out, &fg_iteration_members, list, fg_iteration_at);
  fputs("<p class=\"note\">Each die with its lot: errors against the target.</p>\n</section>\n",
        out);
}

static fg_status write_check_page(fg_context *ctx, const fg_expected_check *check, FILE *out) {
  const fg_subject list = {.object = check, .whole = check};
  const fg_springback_law *law = check->next.law;
  fg_provenance from = {.design = &check->next.target};
  fg_provenance_include_date(&from, law->set[law->sets - 1].date);
  fg_html_begin(out, "Lot against its prediction");
  put_check_first(out, check, &list);
  if (check->bumps) {
    fputs("<section class=\"part\">\n<h1>Every bump</h1>\n<figure>", out);
    put_held_radii(out, check);
    fputs("</figure>\n", out);
    fg_html_table(out, &fg_held_bump_members, &list, fg_held_bump_at);
    fputs("</section>\n", out);
  }
  fputs("<section class=\"part\">\n<h1>The law with this lot</h1>\n", out);
  put_law_change(out, check);
  fputs("</section>\n", out);
  FG_TRY(fg_html_provenance_section(ctx, out, &from));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page of the prediction");
}

static fg_status write_check_file(fg_context *ctx, const fg_expected_check *check, const char *name,
                                  bool page) {
  char *path;
  fg_output output;
  FG_TRY(fg_lot_path(ctx, check->folder, name, &path));
  fg_status status = fg_output_open(ctx, path, &output);
  free(path);
  FG_TRY(status);
  return fg_output_end(ctx, &output,
                       page ? write_check_page(ctx, check, output.stream)
                            : fg_expected_check_write_json(ctx, check, output.stream));
}

fg_status fg_expected_check_write(fg_context *ctx, const fg_expected_check *check) {
  FG_TRY(write_check_file(ctx, check, "expected.html", true));
  return write_check_file(ctx, check, "expected.json", false);
}
