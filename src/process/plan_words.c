/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "process/plan_words.h"

#include <string.h>

#include "core/memory.h"
#include "core/text.h"

size_t fg_plan_find_factor(const fg_plan *plan, const char *name, size_t length) {
  size_t k = 0;
  while (k < plan->factors &&
         !(strlen(plan->name[k]) == length && memcmp(plan->name[k], name, length) == 0))
    k++;
  return k;
}

fg_status fg_word_parse(fg_context *ctx, const fg_plan *plan, const char *text, fg_word *word) {
  *word = (fg_word){0, 1};
  const char *at = text + strspn(text, " ");
  if (*at == '-') word->sign = -1;
  if (*at == '-' || *at == '+') at++;
  for (;;) {
    size_t length = strcspn(at, ":");
    size_t k = fg_plan_find_factor(plan, at, length);
    if (k == plan->factors)
      return fg_fail(ctx, FG_ERR_USAGE,
                     "generator '%s': there is no factor '%.*s'; write a product as A:B:C", text,
                     (int)length, at);
    word->mask ^= (uint32_t)1 << k;
    at += length;
    if (!*at) break;
    at++;
  }
  if (word->mask) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE, "generator '%s' cancels out", text);
}

static int length_of(uint32_t mask) {
  return __builtin_popcount(mask);
}

static fg_status push_word(fg_context *ctx, fg_plan *plan, fg_word word) {
  FG_TRY(fg_memory_reserve(ctx, plan->words + 1, sizeof *plan->word, &plan->word_capacity,
                           (void **)&plan->word));
  FG_TRY(fg_memory_reserve(ctx, plan->words + 1, sizeof *plan->word_sign, &plan->sign_capacity,
                           (void **)&plan->word_sign));
  plan->word[plan->words] = word.mask;
  plan->word_sign[plan->words++] = word.sign;
  if (!plan->resolution || length_of(word.mask) < plan->resolution)
    plan->resolution = length_of(word.mask);
  return FG_OK;
}

fg_status fg_plan_close_words(fg_context *ctx, const fg_word *generating, size_t count,
                              fg_plan *plan) {
  for (size_t g = 0; g < count; g++) {
    size_t before = plan->words;
    FG_TRY(push_word(ctx, plan, generating[g]));
    for (size_t i = 0; i < before; i++) {
      fg_word product = {plan->word[i] ^ generating[g].mask,
                         plan->word_sign[i] * generating[g].sign};
      if (!product.mask)
        return fg_fail(ctx, FG_ERR_USAGE, "two generators say the same, or contradict each other");
      FG_TRY(push_word(ctx, plan, product));
    }
  }
  return FG_OK;
}

int fg_word_value(const fg_word *word, const double *coded) {
  int value = word->sign;
  for (size_t k = 0; k < FG_PLAN_FACTORS; k++)
    if (word->mask >> k & 1 && coded[k] < 0) value = -value;
  return value;
}

static fg_status append_mask(fg_context *ctx, const fg_plan *plan, uint32_t mask, char **text) {
  const char *separator = "";
  for (size_t k = 0; k < plan->factors; k++) {
    if (!(mask >> k & 1)) continue;
    FG_TRY(fg_text_append(ctx, text, "%s%s", separator, plan->name[k]));
    separator = ":";
  }
  return FG_OK;
}

fg_status fg_plan_relation_text(fg_context *ctx, const fg_plan *plan, char **text) {
  *text = NULL;
  FG_TRY(fg_text_append(ctx, text, plan->words ? "I" : ""));
  for (size_t i = 0; i < plan->words; i++) {
    FG_TRY(fg_text_append(ctx, text, plan->word_sign[i] < 0 ? " = -" : " = "));
    FG_TRY(append_mask(ctx, plan, plan->word[i], text));
  }
  return FG_OK;
}

/* Appends one effect and its aliases. */
static fg_status append_aliases(fg_context *ctx, const fg_plan *plan, uint32_t effect,
                                size_t alias_order, char **text) {
  FG_TRY(append_mask(ctx, plan, effect, text));
  for (size_t i = 0; i < plan->words; i++) {
    uint32_t alias = effect ^ plan->word[i];
    if (!alias || (size_t)length_of(alias) > alias_order) continue;
    FG_TRY(fg_text_append(ctx, text, plan->word_sign[i] < 0 ? " = -" : " = "));
    FG_TRY(append_mask(ctx, plan, alias, text));
  }
  return fg_text_append(ctx, text, "\n");
}

fg_status fg_plan_alias_text(fg_context *ctx, const fg_plan *plan, size_t order, size_t alias_order,
                             char **text) {
  *text = NULL;
  if (!plan->words) return fg_text_append(ctx, text, "%s", "");
  for (size_t length = 1; length <= order; length++)
    for (uint32_t effect = 1; effect < (uint32_t)1 << plan->factors; effect++)
      if ((size_t)length_of(effect) == length)
        FG_TRY(append_aliases(ctx, plan, effect, alias_order, text));
  return FG_OK;
}
