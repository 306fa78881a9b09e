/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recursive descent over the formula; every rule returns a set of terms.
 *
 *     sum      = product { ("+" | "-") product }
 *     product  = chain { ("*" | "/") chain }
 *     chain    = power { ":" power }
 *     power    = atom [ "^" whole number ]
 *     atom     = "0" | "1" | name | function "(" name ")" | "I(" sum ")" | "(" sum ")"
 */
#include "foilgauge/formula.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"

typedef struct term_set {
  fg_term *term;
  size_t count, capacity;
  bool single; /* one bare name: ^ means its power, not the crossing of terms */
} term_set;

typedef struct parser {
  fg_context *ctx;
  const char *text, *at;
  fg_formula *formula;
  unsigned depth;
} parser;

static const struct {
  const char *name;
  fg_transform transform;
} FUNCTIONS[] = {
    {"factor", FG_TRANSFORM_FACTOR}, {"log", FG_TRANSFORM_LOG},   {"log10", FG_TRANSFORM_LOG10},
    {"exp", FG_TRANSFORM_EXP},       {"sqrt", FG_TRANSFORM_SQRT}, {"inverse", FG_TRANSFORM_INVERSE},
};
enum { FUNCTION_COUNT = sizeof FUNCTIONS / sizeof *FUNCTIONS, DEEPEST = 64 };

static fg_status parse_sum(parser *p, term_set *set);

static fg_status fail_here(const parser *p, const char *what) {
  return fg_fail(p->ctx, FG_ERR_USAGE, "formula '%s', character %zu: %s", p->text,
                 (size_t)(p->at - p->text) + 1, what);
}

static bool accept_symbol(parser *p, char symbol) {
  while (isspace((unsigned char)*p->at))
    p->at++;
  if (*p->at != symbol) return false;
  p->at++;
  return true;
}

static bool same_term(const fg_term *a, const fg_term *b) {
  return memcmp(a->power, b->power, sizeof a->power) == 0;
}

static size_t find_term(const term_set *set, const fg_term *term) {
  size_t i = 0;
  while (i < set->count && !same_term(&set->term[i], term))
    i++;
  return i;
}

static fg_status add_term(const parser *p, term_set *set, const fg_term *term) {
  if (find_term(set, term) < set->count) return FG_OK;
  if (set->count >= FG_FORMULA_TERMS) return fail_here(p, "more than 2000 terms");
  FG_TRY(fg_memory_reserve(p->ctx, set->count + 1, sizeof *set->term, &set->capacity,
                           (void **)&set->term));
  set->term[set->count++] = *term;
  return FG_OK;
}

static fg_status add_all(const parser *p, term_set *to, const term_set *from) {
  for (size_t i = 0; i < from->count; i++)
    FG_TRY(add_term(p, to, &from->term[i]));
  return FG_OK;
}

/* a:b, where a:a is a. */
static fg_term cross(const fg_term *a, const fg_term *b) {
  fg_term product = *a;
  for (size_t i = 0; i < FG_FORMULA_VARIABLES; i++)
    if (b->power[i] > product.power[i]) product.power[i] = b->power[i];
  return product;
}

static fg_status cross_sets(const parser *p, const term_set *a, const term_set *b,
                            term_set *product) {
  for (size_t i = 0; i < a->count; i++)
    for (size_t k = 0; k < b->count; k++) {
      fg_term term = cross(&a->term[i], &b->term[k]);
      FG_TRY(add_term(p, product, &term));
    }
  return FG_OK;
}

static void replace(term_set *set, term_set *with) {
  free(set->term);
  *set = *with;
  *with = (term_set){0};
}

static size_t name_length(const char *at) {
  size_t length = 0;
  if (isdigit((unsigned char)*at)) return 0;
  /* Bytes above 127 are letters of some language in UTF-8. */
  while (isalnum((unsigned char)at[length]) || at[length] == '_' || at[length] == '.' ||
         (unsigned char)at[length] >= 128)
    length++;
  return length;
}

static fg_status parse_name(parser *p, char **name) {
  while (isspace((unsigned char)*p->at))
    p->at++;
  if (*p->at == '`') {
    const char *end = strchr(p->at + 1, '`');
    if (!end || end == p->at + 1) return fail_here(p, "a ` without its partner");
    FG_TRY(fg_text_print(p->ctx, name, "%.*s", (int)(end - p->at - 1), p->at + 1));
    p->at = end + 1;
    return FG_OK;
  }
  size_t length = name_length(p->at);
  if (!length) return fail_here(p, *p->at ? "a name is expected here" : "the formula ends early");
  FG_TRY(fg_text_print(p->ctx, name, "%.*s", (int)length, p->at));
  p->at += length;
  return FG_OK;
}

static fg_status variable_name(const parser *p, const char *column, fg_transform transform,
                               char **name) {
  for (size_t i = 0; i < FUNCTION_COUNT; i++)
    if (FUNCTIONS[i].transform == transform)
      return fg_text_print(p->ctx, name, "%s(%s)", FUNCTIONS[i].name, column);
  return fg_text_print(p->ctx, name, "%s", column);
}

/* The index of the variable; a new one is appended. */
static fg_status intern_variable(parser *p, const char *column, fg_transform transform,
                                 size_t *index) {
  fg_formula *f = p->formula;
  for (*index = 0; *index < f->variables; ++*index)
    if (strcmp(f->variable[*index].column, column) == 0 &&
        f->variable[*index].transform == transform)
      return FG_OK;
  if (f->variables == FG_FORMULA_VARIABLES) return fail_here(p, "more than 40 variables");
  fg_variable *added = &f->variable[f->variables++];
  added->transform = transform;
  FG_TRY(fg_text_print(p->ctx, &added->column, "%s", column));
  return variable_name(p, column, transform, &added->name);
}

static fg_status add_variable(parser *p, const char *column, fg_transform transform,
                              term_set *set) {
  size_t index = 0;
  fg_term term = {{0}};
  FG_TRY(intern_variable(p, column, transform, &index));
  term.power[index] = 1;
  set->single = true;
  return add_term(p, set, &term);
}

static fg_status parse_function(parser *p, const char *name, term_set *set) {
  char *column = NULL;
  if (strcmp(name, "I") == 0) {
    FG_TRY(parse_sum(p, set));
    return accept_symbol(p, ')') ? FG_OK : fail_here(p, "a ) is missing");
  }
  for (size_t i = 0; i < FUNCTION_COUNT; i++) {
    if (strcmp(name, FUNCTIONS[i].name) != 0) continue;
    fg_status status = parse_name(p, &column);
    if (status == FG_OK) status = add_variable(p, column, FUNCTIONS[i].transform, set);
    free(column);
    if (status != FG_OK) return status;
    return accept_symbol(p, ')') ? FG_OK : fail_here(p, "a ) is missing");
  }
  return fail_here(p, "there are factor, log, log10, exp, sqrt, inverse and I, no other function");
}

/* The constant is the empty product. */
static fg_status parse_constant(parser *p, term_set *set) {
  const fg_term constant = {{0}};
  char *end = NULL;
  long number = strtol(p->at, &end, 10);
  if ((number != 0 && number != 1) || *end == '.') return fail_here(p, "only 0 and 1 are numbers");
  p->at = end;
  if (number == 1) return add_term(p, set, &constant);
  p->formula->constant = false;
  return FG_OK;
}

static fg_status parse_atom(parser *p, term_set *set) {
  char *name = NULL;
  if (accept_symbol(p, '(')) {
    FG_TRY(parse_sum(p, set));
    set->single = false;
    return accept_symbol(p, ')') ? FG_OK : fail_here(p, "a ) is missing");
  }
  if (isdigit((unsigned char)*p->at)) return parse_constant(p, set);
  bool quoted = *p->at == '`';
  FG_TRY(parse_name(p, &name));
  fg_status status = !quoted && accept_symbol(p, '(')
                         ? parse_function(p, name, set)
                         : add_variable(p, name, FG_TRANSFORM_NONE, set);
  free(name);
  return status;
}

/* (a + b)^n: the terms crossed with themselves n - 1 times. */
static fg_status raise_set(const parser *p, long power, term_set *set) {
  fg_status status = FG_OK;
  term_set raised = {0};
  for (long i = 1; i < power && status == FG_OK; i++) {
    size_t before = set->count;
    status = add_all(p, &raised, set);
    if (status == FG_OK) status = cross_sets(p, set, set, &raised);
    if (status == FG_OK) replace(set, &raised);
    if (set->count == before) break;
  }
  free(raised.term);
  return status;
}

static fg_status parse_power(parser *p, term_set *set) {
  FG_TRY(parse_atom(p, set));
  if (!accept_symbol(p, '^')) return FG_OK;
  char *end = NULL;
  while (isspace((unsigned char)*p->at))
    p->at++;
  long power = isdigit((unsigned char)*p->at) ? strtol(p->at, &end, 10) : 0;
  if (power < 1 || power > FG_FORMULA_POWER)
    return fail_here(p, "the power is a whole number from 1 to 30");
  p->at = end;
  if (!set->single) return raise_set(p, power, set);
  for (size_t i = 0; i < FG_FORMULA_VARIABLES; i++)
    if (set->term[0].power[i]) set->term[0].power[i] = (unsigned char)power;
  return FG_OK;
}

static fg_status parse_chain(parser *p, term_set *set) {
  fg_status status = FG_OK;
  term_set right = {0}, product = {0};
  FG_TRY_EXIT(parse_power(p, set));
  while (accept_symbol(p, ':')) {
    FG_TRY_EXIT(parse_power(p, &right));
    FG_TRY_EXIT(cross_sets(p, set, &right, &product));
    replace(set, &product);
    right.count = 0;
  }
exit:
  free(right.term);
  free(product.term);
  return status;
}

/* a/b is a + a:b with all of a's variables in the second. */
static fg_status nest(const parser *p, term_set *left, const term_set *right) {
  fg_term all = {{0}};
  for (size_t i = 0; i < left->count; i++)
    all = cross(&all, &left->term[i]);
  for (size_t i = 0; i < right->count; i++) {
    fg_term term = cross(&all, &right->term[i]);
    FG_TRY(add_term(p, left, &term));
  }
  return FG_OK;
}

static fg_status parse_product(parser *p, term_set *set) {
  fg_status status = FG_OK;
  term_set right = {0}, product = {0};
  FG_TRY_EXIT(parse_chain(p, set));
  for (;;) {
    bool star = accept_symbol(p, '*');
    if (!star && !accept_symbol(p, '/')) break;
    right.count = 0;
    FG_TRY_EXIT(parse_chain(p, &right));
    set->single = false;
    if (!star) {
      FG_TRY_EXIT(nest(p, set, &right));
      continue;
    }
    product.count = 0;
    FG_TRY_EXIT(cross_sets(p, set, &right, &product));
    FG_TRY_EXIT(add_all(p, set, &right));
    FG_TRY_EXIT(add_all(p, set, &product));
  }
exit:
  free(right.term);
  free(product.term);
  return status;
}

static void remove_terms(term_set *set, const term_set *unwanted) {
  size_t kept = 0;
  for (size_t i = 0; i < set->count; i++)
    if (find_term(unwanted, &set->term[i]) == unwanted->count) set->term[kept++] = set->term[i];
  set->count = kept;
}

/* `- 1` removes the constant, `- 0` and `+ 1` restore it. */
static fg_status subtract_terms(parser *p, term_set *set, const term_set *unwanted) {
  const fg_term constant = {{0}};
  remove_terms(set, unwanted);
  if (find_term(unwanted, &constant) < unwanted->count) p->formula->constant = false;
  return FG_OK;
}

static fg_status parse_sum(parser *p, term_set *set) {
  fg_status status = FG_OK;
  term_set right = {0};
  if (++p->depth > DEEPEST) return fail_here(p, "too many brackets");
  bool minus = accept_symbol(p, '-');
  if (!minus) accept_symbol(p, '+');
  bool first = true;
  do {
    right.count = 0;
    right.single = false;
    FG_TRY_EXIT(parse_product(p, &right));
    if (minus)
      FG_TRY_EXIT(subtract_terms(p, set, &right));
    else
      FG_TRY_EXIT(add_all(p, set, &right));
    set->single = first && !minus && right.single;
    first = false;
    minus = accept_symbol(p, '-');
  } while (minus || accept_symbol(p, '+'));
exit:
  p->depth--;
  free(right.term);
  return status;
}

static unsigned degree(const fg_term *term) {
  unsigned sum = 0;
  for (size_t i = 0; i < FG_FORMULA_VARIABLES; i++)
    sum += term->power[i];
  return sum;
}

/* By degree, otherwise as written: a stable insertion. The constant leaves the list. */
static void order_terms(fg_formula *formula, term_set *set) {
  const fg_term constant = {{0}};
  const term_set only_constant = {.term = (fg_term[]){constant}, .count = 1};
  if (find_term(set, &constant) < set->count) formula->constant = true;
  remove_terms(set, &only_constant);
  for (size_t i = 1; i < set->count; i++) {
    fg_term moving = set->term[i];
    size_t k = i;
    for (; k > 0 && degree(&set->term[k - 1]) > degree(&moving); k--)
      set->term[k] = set->term[k - 1];
    set->term[k] = moving;
  }
  formula->term = set->term;
  formula->terms = set->count;
  formula->capacity = set->capacity;
}

/* "y ~" in front, when there is a ~. */
static fg_status parse_response(parser *p) {
  if (!strchr(p->text, '~')) return FG_OK;
  if (accept_symbol(p, '~')) return FG_OK;
  FG_TRY(parse_name(p, &p->formula->response));
  return accept_symbol(p, '~') ? FG_OK : fail_here(p, "a ~ is expected after the response");
}

fg_status fg_formula_parse(fg_context *ctx, const char *text, fg_formula *formula) {
  fg_status status = FG_OK;
  term_set set = {0};
  parser p = {.ctx = ctx, .text = text, .at = text, .formula = formula};
  *formula = (fg_formula){.constant = true};
  FG_TRY_EXIT(parse_response(&p));
  FG_TRY_EXIT(parse_sum(&p, &set));
  accept_symbol(&p, ' ');
  if (*p.at) FG_TRY_EXIT(fail_here(&p, "+, -, :, * or the end is expected here"));
  order_terms(formula, &set);
  return FG_OK;
exit:
  free(set.term);
  fg_formula_free(formula);
  return status;
}
