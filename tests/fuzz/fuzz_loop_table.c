/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on a table, from the text of a CSV file to every report. The input is five lines
 * (response, model, group, order, held-out rows; empty: none) and the table. A report that holds a
 * number that is none is a fault as much as a crash is. */
#include <stdlib.h>
#include <string.h>

#include "foilgauge/loop_model.h"
#include "fuzz.h"

/* Larger tables are only slower. */
enum { ROWS = 48, COLUMNS = 6, PARAMETERS = 12, TEXT = 4096 };

static const char *take_line(char **rest) {
  char *line = *rest, *end = strchr(line, '\n');
  if (!end) return NULL;
  *end = 0;
  *rest = end + 1;
  return *line ? line : NULL;
}

typedef fg_status writer(fg_context *ctx, const fg_loop_report *report, FILE *out);

/* With `check` the table has no such words itself. */
static void write_checked(writer *write, const fg_loop_report *report, bool check) {
  fg_context ctx = {0};
  fuzz_report text;
  if (!fuzz_report_open(&text)) return;
  if (write(&ctx, report, text.out) != FG_OK) abort();
  fuzz_report_close(&text, check);
}

static void write_reports(const fg_loop_report *report, bool check) {
  writer *const writers[] = {fg_loop_write_json, fg_loop_write_text, fg_loop_write_html};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++)
    write_checked(writers[i], report, check);
}

/* The model file is read again and its effects are taken out of the table. */
static void use_model(const fg_loop_report *report, fg_table *table) {
  fg_context ctx = {0};
  fg_loop_model *model = NULL;
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return;
  if (fg_loop_write_model(&ctx, report, out) != FG_OK) abort();
  fclose(out);
  if (fg_loop_model_load(&ctx, fuzz_file((const uint8_t *)text, size), &model) == FG_OK) {
    (void)fg_loop_model_apply(&ctx, model, table);
    fg_loop_model_free(model);
  }
  free(text);
}

static void run_loop(const fg_loop_table_spec *spec, fg_table *table, bool check) {
  fg_context ctx = {0};
  fg_loop_table_problem problem;
  fg_loop_result result;
  const fg_loop_options options = {
      .effects = fg_loop_table_effects(), .seed = 1, .accept_p = 0.2, .simulations = 19};
  if (fg_loop_table_problem_build(&ctx, table, spec, &problem) != FG_OK) return;
  if (problem.problem.parameters <= PARAMETERS &&
      fg_loop_run(&ctx, &problem.problem, &options, &result) == FG_OK) {
    fg_loop_report report = {.path = "table.csv",
                             .sha256 = "",
                             .spec = spec,
                             .problem = &problem,
                             .result = &result,
                             .seed = 1};
    write_reports(&report, check);
    use_model(&report, table);
    fg_loop_result_free(&result);
  }
  fg_loop_table_problem_free(&problem);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_design design;
  fg_table table;
  fg_loop_table_spec spec = {.seed = 1, .design = &design};
  char text[TEXT + 1], *rest = text;
  if (size > TEXT) return 0;
  memcpy(text, data, size);
  text[size] = 0;
  bool check = !strcasestr(text, "nan") && !strcasestr(text, "inf");
  fg_design_default(&design);
  spec.response = take_line(&rest);
  spec.model = take_line(&rest);
  spec.group = take_line(&rest);
  spec.order = take_line(&rest);
  spec.hold_out = take_line(&rest);
  if (!spec.response || !spec.model) return 0;
  if (fg_table_parse(&ctx, "table.csv", rest, strlen(rest), &table) != FG_OK) return 0;
  char *said = NULL; /* every other input as the loop takes what the program itself measured */
  bool own = table.rows % 2 == 0;
  if (own && fg_table_count_words(&ctx, &table, 3, &said) != FG_OK) table.rows = 0;
  free(said);
  if (table.rows && table.rows <= ROWS && table.columns <= COLUMNS) run_loop(&spec, &table, check);
  fg_table_free(&table);
  return 0;
}
