/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of words: they are whole, texts find their entries, names and markup stay, numbers and
 * dates get their form; the choice of a language. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "effect/table_effects.h"
#include "foilgauge/control.h"
#include "foilgauge/picture.h"
#include "foilgauge/words.h"
#include "language/catalogue.h"
#include "quantity/quantity_rows.h"
#include "support/test.h"

static fg_languages *languages;
static const fg_language *german;

static int open_languages(void **state) {
  fg_context ctx = {.message = ""};
  (void)state;
  fg_status status = fg_languages_open(&ctx, &languages);
  if (status != FG_OK) print_error("%s\n", ctx.message);
  german = fg_languages_choose(languages, "de", NULL);
  return status == FG_OK && german ? 0 : -1;
}

static int close_languages(void **state) {
  (void)state;
  fg_languages_close(languages);
  return 0;
}

/* The list that tests of the search read. */
static const char small_list[] =
    "# A comment.\n"
    "msgid \"\"\nmsgstr \"\"\n\"Language: xx\\n\"\n\"X-Decimal: ,\\n\"\n\"X-Date: %d.%m.%Y\\n\"\n\n"
    "msgctxt \"symbol\"\nmsgid \"mm\"\nmsgstr \"mm\"\n\n"
    "msgid \"bump radius\"\nmsgstr \"Bumpradius\"\n"
    "msgid \"It is new.\"\nmsgstr \"Es ist neu.\"\n"
    "msgid \"Say \\\"yes\\\".\"\nmsgstr \"Sag ja.\"\n"
    "msgid \"{number} of {number2} failed\"\nmsgstr \"von {number2} schlecht: {number}\"\n"
    "msgid \"closed {time} by {name}\"\nmsgstr \"zu {time} von {name}\"\n"
    "msgid \"Bump {number}: {words}\"\nmsgstr \"{words} an {number}\"\n";

static fg_language small_language(void) {
  fg_context ctx = {.message = ""};
  fg_language language = {.decimal = 0};
  fg_status status = fg_catalogue_read(&ctx, "xx.po", small_list, &language);
  if (status != FG_OK) print_error("%s\n", ctx.message);
  assert_int_equal(status, FG_OK);
  return language;
}

static void assert_text(const fg_language *language, const char *text, const char *expected) {
  char *translated = fg_phrase_translate(language, text);
  if (!translated || strcmp(translated, expected) != 0)
    fail_msg("\"%s\": \"%s\", expected \"%s\"", text, translated ? translated : "(none)", expected);
  free(translated);
}

static void assert_no_text(const fg_language *language, const char *text) {
  char *translated = fg_phrase_translate(language, text);
  if (translated) fail_msg("\"%s\" became \"%s\"", text, translated);
}

static void texts_find_their_entries(void **state) {
  fg_language language = small_language();
  (void)state;
  assert_text(&language, "bump radius", "Bumpradius");
  assert_text(&language, "Say \"yes\".", "Sag ja.");
  assert_text(&language, "3 of 20 failed", "von 20 schlecht: 3");
  assert_text(&language, "closed 2026-03-01 14:02:33 by Ada of 2.5",
              "zu 01.03.2026 14:02:33 von Ada of 2.5");
  assert_text(&language, "Bump 3: bump radius", "Bumpradius an 3");
  assert_text(&language, "It is new. 3 of 4 failed. It is new.",
              "Es ist neu. von 4 schlecht: 3. Es ist neu.");
  assert_text(&language, "(bump radius, mm)", "(Bumpradius, mm)");
  assert_text(&language, "3.5 ± 0.25 mm, ≤ 4.5", "3,5 ± 0,25 mm, ≤ 4,5");
  assert_no_text(&language, "bump radii");
  assert_no_text(&language, "Bump 3: bump radii");
  assert_no_text(&language, "3.5 foils");
  fg_catalogue_free(&language);
}

/* A text that nobody foresaw costs no more than the page's time. */
static void long_texts_end(void **state) {
  fg_language language = small_language();
  char text[4000];
  (void)state;
  for (size_t i = 0; i + 12 < sizeof text; i += 10)
    strcpy(text + i, "Bump 1: a, ");
  assert_no_text(&language, text);
  fg_catalogue_free(&language);
}

static void assert_html(const fg_language *language, const char *html, const char *expected) {
  char *page = NULL;
  size_t size;
  FILE *out = open_memstream(&page, &size);
  assert_non_null(out);
  fg_language_write_html(language, html, strlen(html), out, NULL);
  fclose(out);
  assert_string_equal(page, expected);
  free(page);
}

static void markup_and_names_stay(void **state) {
  fg_language language = small_language();
  (void)state;
  assert_html(&language,
              "<html lang=\"en\"><p title=\"bump radius\">It is\n  new. <b>3.5&nbsp;mm</b></p>",
              "<html lang=\"xx\"><p title=\"Bumpradius\">Es ist neu. <b>3,5 mm</b></p>");
  assert_html(&language, "<p translate=\"no\">bump radius <p>3.5</p> bump radius</p>bump radius",
              "<p translate=\"no\">bump radius <p>3.5</p> bump radius</p>Bumpradius");
  assert_html(&language, "<input value=\"bump radius\" placeholder='bump radius'>3.5",
              "<input value=\"bump radius\" placeholder='Bumpradius'>3,5");
  assert_html(&language,
              "<script>a < b; 'bump radius'</script><a href='/x?y=1.5'>Say &quot;yes&quot;.</a>",
              "<script>a < b; 'bump radius'</script><a href='/x?y=1.5'>Sag ja.</a>");
  assert_html(&language, "<p>unknown &lt;b&gt; 1.5</p><", "<p>unknown &lt;b&gt; 1.5</p><");
  fg_catalogue_free(&language);
}

static void numbers_get_the_decimal_sign(void **state) {
  fg_language language = small_language();
  (void)state;
  assert_html(&language,
              "<td>3.25</td><td>−0.5</td><td>1e-3</td><td>1.5e+03 %</td><td>0.1 … 0.2</td>",
              "<td>3,25</td><td>−0,5</td><td>1e-3</td><td>1,5e+03 %</td><td>0,1 … 0,2</td>");
  /* Versions, addresses and names are no numbers. */
  assert_html(
      &language,
      "<td>1.12.0</td><td>127.0.0.1</td><td>7_2.5</td><td>2.5.png</td><td>2026-03-01T14:02</td>",
      "<td>1.12.0</td><td>127.0.0.1</td><td>7_2.5</td><td>2.5.png</td><td>01.03.2026 14:02</td>");
  fg_catalogue_free(&language);
}

static void assert_refused(const char *list, const char *words) {
  fg_context ctx = {.message = ""};
  fg_language language = {.decimal = 0};
  assert_int_equal(fg_catalogue_read(&ctx, "xx.po", list, &language), FG_ERR_DATA);
  if (!strstr(ctx.message, words)) fail_msg("\"%s\" lacks \"%s\"", ctx.message, words);
  fg_catalogue_free(&language);
}

static void broken_lists_are_refused(void **state) {
  (void)state;
  assert_refused("", "no header");
  assert_refused("msgid \"\"\nmsgstr \"Language: xx\\n\"\n", "xx.po:2: the header needs");
  assert_refused("msgid \"a\nmsgstr \"b\"\n", "xx.po:1: a quote is not closed");
  assert_refused("msgid \"a\"\nmsgid \"b\"\n", "has no msgstr");
  assert_refused("\"a\"\n", "without msgid");
  assert_refused("word\n", "xx.po:1: this is no line");
}

static const fg_language *language_at(size_t i) {
  char tag[16] = "";
  const char *file = fg_language_lists[i].file; /* "de.po" */
  if (!file) return NULL;
  snprintf(tag, sizeof tag, "%.*s", (int)strcspn(file, "."), file);
  const fg_language *language = fg_languages_choose(languages, tag, NULL);
  assert_non_null(language);
  return language;
}

/* Every place of an entry's text is in both of its texts, and no entry comes twice. */
static void lists_are_whole(void **state) {
  (void)state;
  const fg_language *language;
  for (size_t l = 0; (language = language_at(l)); l++)
    for (size_t i = 0; i < language->count; i++) {
      const fg_phrase *phrase = &language->phrases[i];
      if (i && !strcmp(phrase->source, language->phrases[i - 1].source))
        fail_msg("%s.po:%zu: comes twice: %s", language->tag, phrase->line, phrase->source);
      for (const char *at = phrase->target; (at = strchr(at, '{')); at++) {
        char place[24];
        size_t length = fg_place_length(at);
        snprintf(place, sizeof place, "%.*s", (int)length, at);
        if (length && !strstr(phrase->source, place))
          fail_msg("%s.po:%zu: %s is not in its msgid", language->tag, phrase->line, place);
      }
    }
}

static void assert_has_words(const char *owner, const char *text) {
  const fg_language *language;
  for (size_t i = 0; text && (language = language_at(i)); i++) {
    char *translated = fg_phrase_translate(language, text);
    if (!translated) fail_msg("%s.po lacks the words of %s: %s", language->tag, owner, text);
    free(translated);
  }
}

static void flags_have_words(const fg_flag_words *flags) {
  for (; flags->name; flags++)
    assert_has_words(flags->name, flags->plain);
}

static void tables_of_words_are_known(void **state) {
  static const fg_quantity_owner owners[] = {FG_QUANTITY_OF_BUMP, FG_QUANTITY_OF_FOIL,
                                             FG_QUANTITY_OF_BEAM};
  (void)state;
  for (size_t o = 0; o < sizeof owners / sizeof *owners; o++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(owners[o], &count);
    for (size_t i = 0; i < count; i++)
      if (rows[i].kind != FG_QUANTITY_PAIR) assert_has_words(rows[i].name, rows[i].words);
  }
  flags_have_words(fg_foil_flag_words());
  flags_have_words(fg_bump_flag_words());
  flags_have_words(fg_beam_flag_words());
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    assert_has_words("a rule", fg_run_rule_words(rule));
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++) {
    assert_has_words(words->name, words->meaning);
    assert_has_words(words->name, words->cure);
  }
}

/* The words of effects stand in sentences of the station's causes, where a name would hide them. */
static void effects_have_words(const fg_loop_effect *effects) {
  for (; effects->id; effects++) {
    const char *over[] = {"time", "die", "temperature_C"},
               *more = effects->pair ? " and duration_h" : "";
    for (size_t i = 0; effects->accepts && i < sizeof over / sizeof *over; i++) {
      char text[400];
      snprintf(text, sizeof text, "%s %s%s", effects->words, over[i], more);
      assert_has_words(effects->id, text);
      snprintf(
          text, sizeof text,
          "from 2026-03-01 to 2026-05-03: bump radius −0.41 %% (−0.0136 mm), U 0.08 %%; tied with "
          "%s %s%s, die B on the same foils; a column of what changed then (--context) would tell",
          effects->words, over[i], more);
      char *translated = fg_phrase_translate(german, text);
      if (!translated || strstr(translated, effects->words))
        fail_msg("%s: \"%s\" became \"%s\"", effects->id, text, translated ? translated : "(none)");
      free(translated);
    }
  }
}

static void effects_of_tables_are_known(void **state) {
  (void)state;
  effects_have_words(fg_loop_table_effects());
  effects_have_words(fg_loop_noise_effects());
  effects_have_words(fg_loop_curve_effects());
  assert_has_words("a cause",
                   "with temperature_C above 22.1: bump radius +0.41 % (+0.0136 mm), U 0.08 %");
  assert_has_words("a cause", "with hour from 6 to 14: bump radius +0.41 % (+0.0136 mm), U 0.08 %");
  assert_has_words(
      "a cause",
      "from 2026-03-01 08:02 to 2026-03-01 14:30: bump radius +0.41 % (+0.0136 mm), U 0.08 %");
}

static const char *choose(const char *recipe, const char *accepted) {
  const fg_language *language = fg_languages_choose(languages, recipe, accepted);
  return language ? fg_language_tag(language) : "en";
}

static void recipe_or_browser_choose(void **state) {
  (void)state;
  assert_string_equal(choose(NULL, NULL), "en");
  assert_string_equal(choose("", "de"), "de");
  assert_string_equal(choose("", "de-AT,en;q=0.8"), "de");
  assert_string_equal(choose("", "en-US,en;q=0.9,de;q=0.8"), "en");
  assert_string_equal(choose("", "fr, de;q=0.7, en;q=0.3"), "de");
  assert_string_equal(choose("", "de;q=0, en"), "en");
  assert_string_equal(choose("", "den, deu"), "en");
  assert_string_equal(choose("", ";;,,q=,de;q=x"), "en");
  assert_string_equal(choose("de", "en"), "de");
  assert_string_equal(choose("en", "de"), "en");
  assert_true(fg_language_is_known("de") && fg_language_is_known("en") &&
              !fg_language_is_known("d"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(texts_find_their_entries),    cmocka_unit_test(long_texts_end),
      cmocka_unit_test(markup_and_names_stay),       cmocka_unit_test(numbers_get_the_decimal_sign),
      cmocka_unit_test(broken_lists_are_refused),    cmocka_unit_test(lists_are_whole),
      cmocka_unit_test(tables_of_words_are_known),   cmocka_unit_test(recipe_or_browser_choose),
      cmocka_unit_test(effects_of_tables_are_known),
  };
  return cmocka_run_group_tests(tests, open_languages, close_languages);
}
