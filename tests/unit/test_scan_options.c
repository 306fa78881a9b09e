/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of a scan command that spoil a scan are named; those that do not are left alone. */
#include <stdio.h>
#include <string.h>

#include "foilgauge/picture.h"
#include "station/scan_options.h"
#include "support/test.h"

static void harmless_commands_are_left_alone(void **state) {
  static const char *const commands[] = {
      "",
      "scanimage --mode Gray --depth 16 --resolution 4800 --format png --output-file {file}",
      "scanimage --mode='16 bits gray' --gamma=1.0 --brightness 0 --contrast=0 > {file}",
      "scanimage --gamma-correction 'User defined (Gamma=1.0)' --sharpness 0 --depth=8 >{file}",
      "scanimage --custom-gamma=yes --gamma-table '[0]0-[4095]255' --swdeskew=no > {file}",
      "scanimage --gamma $GAMMA --mode \"$MODE\" > {file}",
      "scanimage --format tiff --highlight 255 --preview=no --compression None > {file}",
      "cp '/srv/jpeg --gamma 2.2/scan.png' {file}",
      "scanimage --sharpness",
      "sh /etc/foilgauge/scan.sh {file} 4800",
  };
  char words[1000];
  (void)state;
  for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
    in_row("commands[%zu]", i);
    assert_int_equal(fg_scan_options_inspect(commands[i], words, sizeof words), 0);
    assert_string_equal(words, "");
  }
}

static void harmful_options_are_named_with_what_is_right(void **state) {
  static const struct {
    const char *command, *option, *finding, *instead;
  } rows[] = {
      {"scanimage --mode Lineart > {file}", "--mode Lineart:", "few_levels", "--mode Gray."},
      {"scanimage --mode=lineart > {file}", "--mode lineart:", "few_levels", "--mode Gray."},
      {"scanimage --mode 'Color Lineart'", "--mode 'Color Lineart':", "few_levels", "--mode Gray."},
      {"scanimage --depth 1", "--depth 1:", "few_levels", "--depth 16, or 8."},
      {"scanimage --format jpeg", "--format jpeg:", "block_noise", "--format png."},
      {"scanimage --compression JPEG", "--compression JPEG:", "block_noise", "--compression None."},
      {"scanimage --gamma 2.2", "--gamma 2.2:", "tone_curve", "--gamma 1."},
      {"scanimage --gamma=0.99", "--gamma 0.99:", "tone_curve", "--gamma 1."},
      {"scanimage --gamma-correction \"High contrast printing\"",
       "--gamma-correction 'High contrast printing':", "tone_curve", "(Gamma=1.0)'."},
      {"scanimage --gamma-table [0]0-[128]200-[255]255", "[0]0-[128]200-[255]255", "tone_curve",
       "'[0]0-[255]255'."},
      {"scanimage --gamma-table [0]20-[255]255", "[0]20-[255]255", "tone_curve",
       "'[0]0-[255]255'."},
      {"scanimage --contrast -10", "--contrast -10:", "tone_curve", "--contrast 0, or without"},
      {"scanimage --highlight 80", "--highlight 80:", "clipped_levels", "--highlight 100."},
      {"scanimage --sharpness 2;true", "--sharpness 2:", "sharpened", "--sharpness 0."},
      {"scanimage --swdeskew > {file}", "--swdeskew:", "correlated_noise", "--swdeskew=no."},
      {"scanimage | convert - -unsharp 0x1 {file}", "-unsharp:", "sharpened", "Leave it out."},
  };
  char words[1000];
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    const fg_picture_words *found = fg_picture_finding_words();
    assert_int_equal(fg_scan_options_inspect(rows[i].command, words, sizeof words), 1);
    while (found->name && strcmp(found->name, rows[i].finding) != 0)
      found++;
    assert_non_null(found->name);
    assert_has(words, rows[i].option);
    assert_has(words, found->meaning);
    assert_has(words, rows[i].instead);
  }
}

static void every_option_of_a_command_is_told_and_clipped_to_the_room(void **state) {
  char words[1000], narrow[40];
  static const char command[] = "scanimage --depth 1 --sharpness 1 --gamma 1.8 --format jpeg";
  (void)state;
  assert_int_equal(fg_scan_options_inspect(command, words, sizeof words), 4);
  assert_has(words, "--depth 1:");
  assert_has(words, "--format jpeg:");
  assert_int_equal(fg_scan_options_inspect(command, narrow, sizeof narrow), 4);
  assert_true(strlen(narrow) < sizeof narrow);
}

/* Settings that a finding names are as the drivers spell them: options of scanimage, capabilities,
 * properties; and no finding is without a cure. */
static void findings_name_settings_as_drivers_spell_them(void **state) {
  (void)state;
  for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++) {
    assert_true(strlen(words->meaning) > 20 && strlen(words->cure) > 10);
    assert_int_equal(words->cure[strlen(words->cure) - 1], '.');
    assert_true(!words->twain[0] || strstr(words->twain, "ICAP_"));
    assert_true(!words->wia[0] || strstr(words->wia, "WIA_IP"));
    assert_true(!words->sane[0] || words->sane[0] == '-' || strstr(words->sane, "scan.sh"));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(harmless_commands_are_left_alone),
      cmocka_unit_test(harmful_options_are_named_with_what_is_right),
      cmocka_unit_test(every_option_of_a_command_is_told_and_clipped_to_the_room),
      cmocka_unit_test(findings_name_settings_as_drivers_spell_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
