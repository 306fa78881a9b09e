/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foilgauge doe plan: factors in, a run sheet in random order out. */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/facts.h"
#include "cli/values.h"
#include "foilgauge/doe.h"
#include "foilgauge/file.h"
#include "foilgauge/memory.h"
#include "foilgauge/plan.h"
#include "foilgauge/text.h"

typedef struct plan_arguments {
  fg_plan_options options;
  fg_coding coding[FG_PLAN_FACTORS];
  fg_plan_factor factor[FG_PLAN_FACTORS];
  const char *generator[FG_PLAN_FACTORS], *block_generator[FG_PLAN_FACTORS];
  const char *hard[FG_PLAN_FACTORS];
  size_t hard_count;
  const char *column[FG_PLAN_FACTORS]; /* empty ones, to be filled in by hand */
  size_t columns;
  fg_rounding round[FG_PLAN_FACTORS];
  size_t rounds;
  const char *output_path, *page_path;
  bool decimal_comma;
} plan_arguments;

enum {
  OPTION_KIND = 256,
  OPTION_FACTOR,
  OPTION_GENERATOR,
  OPTION_BLOCKS,
  OPTION_REPLICATES,
  OPTION_CENTRES,
  OPTION_REPLICATE_BLOCKS,
  OPTION_AXIAL_BLOCK,
  OPTION_AXIAL,
  OPTION_HARD,
  OPTION_SEED,
  OPTION_COLUMN,
  OPTION_ROUND,
  OPTION_HTML
};

static const struct argp_option options[] = {
    {"factor", OPTION_FACTOR, "NAME=LOW:HIGH", 0, "A factor and its levels; once for each", 0},
    {"kind", OPTION_KIND, "KIND", 0,
     "factorial (default), composite, thesis (the thesis's composite: axial runs at 3, one centre "
     "run), box-behnken",
     0},
    {"generator", OPTION_GENERATOR, "D=A:B:C", 0, "A fraction: D is set as the product", 0},
    {"replicates", OPTION_REPLICATES, "N", 0, "Make every run (but the centre) N times", 1},
    {"centre", OPTION_CENTRES, "N", 0, "Centre runs, in every block", 1},
    {"axial", OPTION_AXIAL, "X", 0, "Axial distance, coded (default: rotatable)", 1},
    {"blocks", OPTION_BLOCKS, "A:B:C", 0, "Two blocks by the sign of a product; may be repeated",
     2},
    {"block-replicates", OPTION_REPLICATE_BLOCKS, NULL, 0, "Every replicate is a block", 2},
    {"block-axial", OPTION_AXIAL_BLOCK, NULL, 0, "Corners and axial runs are two blocks", 2},
    {"hard", OPTION_HARD, "NAME", 0,
     "Hard to change: runs at one setting stay together as a whole plot", 2},
    {"seed", OPTION_SEED, "N", 0, "Of the random order (default: @seed@)", 3},
    {"column", OPTION_COLUMN, "NAME", 0, "An empty column to fill in (default: scan)", 3},
    {"round", OPTION_ROUND, "NAME=STEP", 0,
     "Settings of a factor are multiples of STEP, as the oven can be set; once for each factor", 0},
    {"output", 'o', "RUNS.csv", 0,
     "Write the run sheet here (default: standard output), and the factors' limits and steps "
     "beside "
     "it, as RUNS.plan.json, where `foilgauge doe` finds them",
     3},
    FG_CLI_DECIMAL_COMMA_ROW(3),
    {"html", OPTION_HTML, "RUNS.html", 0, "The run sheet as a page, to print and fill in", 3},
    {0},
};

static const char doc[] =
    "Plan an experiment: write its run sheet, in random order.\v"
    "Name the scans of each run in the empty column, then:\n"
    "  foilgauge doe RUNS.csv --scans scan --response overall.springback_error_pct \\\n"
    "    --model ...\n\n"
    "What a fraction cannot tell apart is said on standard error.\n\n"
    "@exit_done@";

static void add_text(struct argp_state *state, const char **list, size_t *count, const char *text) {
  if (*count == FG_PLAN_FACTORS)
    argp_error(state, "at most %d of one option; '%s' is too many", FG_PLAN_FACTORS, text);
  list[(*count)++] = text;
}

static void parse_factor(struct argp_state *state, const char *text, plan_arguments *a) {
  fg_context ctx = {0};
  size_t place = a->options.factors;
  if (place == FG_PLAN_FACTORS) argp_error(state, "--factor: at most %d", FG_PLAN_FACTORS);
  if (fg_coding_parse(&ctx, text, &a->coding[place]) != FG_OK)
    argp_error(state, "--factor: %s", ctx.message);
  a->options.factors++;
}

static void parse_round(struct argp_state *state, const char *text, plan_arguments *a) {
  fg_context ctx = {0};
  if (a->rounds == FG_PLAN_FACTORS) argp_error(state, "--round: at most %d", FG_PLAN_FACTORS);
  if (fg_rounding_parse(&ctx, text, &a->round[a->rounds]) != FG_OK)
    argp_error(state, "--round: %s", ctx.message);
  a->rounds++;
}

static void parse_kind(struct argp_state *state, const char *text, plan_arguments *a) {
  static const struct {
    const char *name;
    fg_plan_kind kind;
    double axial;
    size_t centres;
  } kinds[] = {{"factorial", FG_PLAN_FACTORIAL, 0, 0},
               {"composite", FG_PLAN_COMPOSITE, 0, 0},
               {"thesis", FG_PLAN_COMPOSITE, 3, 1},
               {"box-behnken", FG_PLAN_BOX_BEHNKEN, 0, 0}};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    if (strcmp(text, kinds[i].name) != 0) continue;
    a->options.kind = kinds[i].kind;
    if (kinds[i].axial > 0) a->options.axial = kinds[i].axial;
    if (kinds[i].centres > 0) a->options.centre_points = kinds[i].centres;
    return;
  }
  argp_error(state, "--kind: '%s' is none of factorial, composite, thesis, box-behnken", text);
}

static void parse_axial(struct argp_state *state, const char *text, plan_arguments *a) {
  char *end;
  a->options.axial = strtod(text, &end);
  if (end == text || *end || !(a->options.axial > 0 && a->options.axial < 100))
    argp_error(state, "--axial: '%s' is not a number from 0 to 100", text);
}

static const fg_cli_value values[] = {
    FG_CLI_NUMBER(OPTION_REPLICATES, plan_arguments, options.replicates, 0, FG_PLAN_RUNS),
    FG_CLI_NUMBER(OPTION_CENTRES, plan_arguments, options.centre_points, 0, FG_PLAN_RUNS),
    FG_CLI_NUMBER(OPTION_SEED, plan_arguments, options.seed, 0, FG_PLAN_RUNS),
    FG_CLI_VALUE(OPTION_REPLICATE_BLOCKS, plan_arguments, options.replicate_blocks),
    FG_CLI_VALUE(OPTION_AXIAL_BLOCK, plan_arguments, options.composite_blocks),
    FG_CLI_VALUE(OPTION_HTML, plan_arguments, page_path),
    FG_CLI_VALUE('o', plan_arguments, output_path),
    FG_CLI_VALUE(FG_CLI_DECIMAL_COMMA, plan_arguments, decimal_comma),
    {0},
};

static error_t parse_plan_option(int key, char *text, struct argp_state *state) {
  plan_arguments *a = state->input;
  if (fg_cli_keep_value(values, key, text, state)) return 0;
  switch (key) {
  case OPTION_KIND:
    parse_kind(state, text, a);
    break;
  case OPTION_FACTOR:
    parse_factor(state, text, a);
    break;
  case OPTION_GENERATOR:
    add_text(state, a->generator, &a->options.generators, text);
    break;
  case OPTION_BLOCKS:
    add_text(state, a->block_generator, &a->options.block_generators, text);
    break;
  case OPTION_HARD:
    add_text(state, a->hard, &a->hard_count, text);
    break;
  case OPTION_COLUMN:
    add_text(state, a->column, &a->columns, text);
    break;
  case OPTION_AXIAL:
    parse_axial(state, text, a);
    break;
  case OPTION_ROUND:
    parse_round(state, text, a);
    break;
  case ARGP_KEY_ARG:
    argp_error(state, "'%s' is no option; factors are given as --factor NAME=LOW:HIGH", text);
    break;
  case ARGP_KEY_END:
    if (!a->options.factors) argp_error(state, "no --factor was given");
    break;
  default:
    return ARGP_ERR_UNKNOWN;
  }
  return 0;
}

static fg_status name_factors(fg_context *ctx, plan_arguments *a) {
  for (size_t i = 0; i < a->options.factors; i++)
    a->factor[i] = (fg_plan_factor){
        .name = a->coding[i].name, .low = a->coding[i].low.value, .high = a->coding[i].high.value};
  for (size_t h = 0; h < a->hard_count; h++) {
    bool found = false;
    for (size_t i = 0; i < a->options.factors; i++)
      if (!strcmp(a->hard[h], a->factor[i].name)) found = a->factor[i].hard_to_change = true;
    if (!found)
      return fg_fail(ctx, FG_ERR_USAGE, "--hard %s: there is no factor of that name", a->hard[h]);
  }
  for (size_t r = 0; r < a->rounds; r++) {
    bool found = false;
    for (size_t i = 0; i < a->options.factors; i++) {
      if (strcmp(a->round[r].name, a->factor[i].name) != 0) continue;
      a->factor[i].step = a->round[r].step;
      found = true;
    }
    if (!found)
      return fg_fail(ctx, FG_ERR_USAGE, "--round %s: there is no factor of that name",
                     a->round[r].name);
  }
  a->options.factor = a->factor;
  a->options.generator = a->generator;
  a->options.block_generator = a->block_generator;
  return FG_OK;
}

static fg_status add_empty_columns(fg_context *ctx, const plan_arguments *a, fg_table *table) {
  const char **words = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, table->rows, sizeof *words, (void **)&words));
  for (size_t i = 0; i < table->rows; i++)
    words[i] = "";
  for (size_t k = 0; k < a->columns && status == FG_OK; k++)
    status = fg_table_add_words(ctx, table, a->column[k], words, table->rows);
  free(words);
  return status;
}

typedef struct sheet {
  const plan_arguments *arguments;
  const fg_plan *plan;
} sheet;

static fg_status write_sheet(fg_context *ctx, void *user, FILE *out) {
  const sheet *of = user;
  fg_table table = {0};
  char *text = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_plan_table(ctx, of->plan, &table));
  FG_TRY_EXIT(add_empty_columns(ctx, of->arguments, &table));
  FG_TRY_EXIT(fg_table_format(ctx, &table, &text));
  fputs(text, out);
exit:
  free(text);
  fg_table_free(&table);
  return status;
}

static fg_status print_plan_summary(fg_context *ctx, const fg_plan *plan) {
  char *relation = NULL, *aliases = NULL;
  fprintf(stderr, "%zu run%s", plan->runs, fg_plural(plan->runs));
  if (plan->blocks > 1) fprintf(stderr, " in %zu blocks", plan->blocks);
  if (plan->plots) fprintf(stderr, ", %zu whole plots", plan->plots);
  if (plan->axial > 0) fprintf(stderr, ", axial distance %.4g", plan->axial);
  if (plan->resolution) fprintf(stderr, ", resolution %d", plan->resolution);
  fputc('\n', stderr);
  fg_status status = fg_plan_relation_text(ctx, plan, &relation);
  if (status == FG_OK) status = fg_plan_alias_text(ctx, plan, 2, 3, &aliases);
  if (status == FG_OK && *relation) fprintf(stderr, "%s\nnot told apart:\n%s", relation, aliases);
  free(relation);
  free(aliases);
  return status;
}

static fg_status print_notes(fg_context *ctx, const fg_plan *plan) {
  char *notes, *rest = NULL;
  FG_TRY(fg_plan_notes(ctx, plan, &notes));
  for (char *line = strtok_r(notes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
    fprintf(stderr, "foilgauge: note: %s\n", line);
  free(notes);
  return FG_OK;
}

/* Writes beside a sheet that is a file the facts that a spreadsheet would lose. */
static fg_status write_beside(fg_context *ctx, const plan_arguments *a, const fg_plan *plan) {
  fg_output output;
  char *path;
  if (!a->output_path || !strcmp(a->output_path, "-") || !strncmp(a->output_path, "/dev/", 5))
    return FG_OK;
  FG_TRY(fg_plan_beside(ctx, a->output_path, &path));
  fg_status status = fg_output_open(ctx, path, &output);
  free(path);
  FG_TRY(status);
  return fg_output_end(ctx, &output, fg_plan_write_json(ctx, plan, output.stream));
}

static fg_status write_plan_page(fg_context *ctx, const plan_arguments *a, const fg_plan *plan) {
  fg_output output;
  if (!a->page_path) return FG_OK;
  FG_TRY(fg_output_open(ctx, a->page_path, &output));
  return fg_output_end(ctx, &output,
                       fg_plan_write_html(ctx, plan, a->column, a->columns, output.stream));
}

/* Refuses to overwrite a sheet that somebody filled in. A file that is no table is not checked. */
static fg_status check_unfilled(fg_context *ctx, const plan_arguments *a) {
  fg_context unused = {.message = ""};
  fg_table table;
  char sum[65];
  bool filled = false;
  if (!a->output_path || access(a->output_path, R_OK) != 0 || !strncmp(a->output_path, "/dev/", 5))
    return FG_OK;
  if (fg_table_load(&unused, a->output_path, &table, sum) != FG_OK) return FG_OK;
  for (size_t i = 0; i < a->columns; i++) {
    const fg_column *column;
    if (fg_table_find(&unused, &table, a->column[i], &column) == FG_OK)
      filled = filled || column->missing_count < table.rows;
  }
  fg_table_free(&table);
  if (!filled) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE,
                 "%s: somebody has filled in this sheet: name another file, or move it away",
                 a->output_path);
}

static fg_status write_plan(fg_context *ctx, const plan_arguments *a, const fg_plan *plan) {
  fg_output output;
  sheet of = {a, plan};
  FG_TRY(check_unfilled(ctx, a));
  FG_TRY(fg_output_open(ctx, a->output_path, &output));
  FG_TRY(fg_output_end(ctx, &output,
                       fg_csv_write(ctx, a->decimal_comma, write_sheet, &of, output.stream)));
  FG_TRY(write_beside(ctx, a, plan));
  FG_TRY(write_plan_page(ctx, a, plan));
  FG_TRY(print_notes(ctx, plan));
  return print_plan_summary(ctx, plan);
}

const struct argp fg_doe_plan_parser = {
    options, parse_plan_option, "--factor NAME=LOW:HIGH...", doc, NULL, fg_cli_fill, NULL};

int fg_cmd_doe_plan(int argc, char **argv) {
  fg_context ctx = {0};
  fg_plan plan = {0};
  plan_arguments arguments = {.options.seed = FG_CLI_SEED};
  fg_status status = fg_cli_parse(&ctx, &fg_doe_plan_parser, argc, argv, &arguments);
  if (status != FG_OK) return fg_cli_fail(&ctx, status);
  if (!arguments.columns) arguments.column[arguments.columns++] = "scan";
  status = name_factors(&ctx, &arguments);
  if (status == FG_OK) status = fg_plan_make(&ctx, &arguments.options, &plan);
  if (status == FG_OK) status = write_plan(&ctx, &arguments, &plan);
  fg_plan_free(&plan);
  return status == FG_OK ? 0 : fg_cli_fail(&ctx, status);
}
