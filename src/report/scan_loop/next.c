/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recommended next step after the loop on scans: one sentence, and its commands. */
#include <string.h>

#include "core/text.h"
#include "report/scan_loop/parts.h"

/* Sources of the effects found: they decide the correction to recommend. */
typedef struct sources {
  bool scanner, part, width, bumps;
  bool curve; /* something without a name is among it */
} sources;

static bool of_glass(const fg_scan_result_claim *claim) {
  if (!claim->free) return strncmp(claim->id, "scan.", 5) == 0;
  return claim->coordinate == FG_SCAN_X || claim->coordinate == FG_SCAN_Y;
}

static bool has_row_jumps(const fg_scan_result *result) {
  for (size_t i = 0; i < result->scans; i++)
    if (result->scan[i].before->picture.findings & FG_PICTURE_ROW_JUMPS) return true;
  return false;
}

static sources find_sources(const fg_scan_result *result) {
  sources found = {.bumps = result->bumps.curve != NULL};
  for (size_t i = 0; i < result->claims; i++) {
    const fg_scan_result_claim *claim = &result->claim[i];
    found.curve = found.curve || claim->free;
    if (claim->of_width)
      found.width = true;
    else if (of_glass(claim))
      found.scanner = true;
    else
      found.part = true;
  }
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    found.bumps = found.bumps || result->bumps.response[r].claims;
  return found;
}

/* Returns the finding for which one of the scans is no source of a model; NULL: none. */
static const fg_picture_words *find_spoiling(const fg_scan_result *result) {
  const fg_picture_words *words = NULL;
  for (size_t i = 0; i < result->scans && !words; i++)
    words = fg_picture_spoils_model(result->scan[i].before->picture.findings);
  return words;
}

static bool has_deviating_land(const fg_scan_result *result) {
  for (size_t i = 0; i < result->scans; i++)
    for (size_t k = 0; k < result->scan[i].before->foil_count; k++)
      if (result->scan[i].before->foils[k].flags & FG_FOIL_LAND_DEVIATES) return true;
  return false;
}

static bool knows_diameters(const fg_scan_result *result) {
  return result->scans && result->scan[0].before->design.discs.count > 0;
}

static fg_status add_scans(fg_context *ctx, const fg_scan_result *result, char **command) {
  if (result->discs)
    FG_TRY(fg_text_append(ctx, command,
                          knows_diameters(result) ? " --design DIAMETERS.json" : " --form discs"));
  if (result->same_foil) FG_TRY(fg_text_append(ctx, command, " --same-foil"));
  if (result->without) FG_TRY(fg_text_append(ctx, command, " --without %s", result->without));
  for (size_t i = 0; i < result->scans; i++) {
    if (result->scan[i].hold_out) FG_TRY(fg_text_append(ctx, command, " --hold-out"));
    FG_TRY(fg_text_append_word(ctx, command, result->scan[i].before->scan));
  }
  return FG_OK;
}

static fg_status correct_by_model(fg_context *ctx, const fg_scan_result *result, char **commands) {
  FG_TRY(fg_text_append(ctx, commands, "foilgauge loop"));
  FG_TRY(add_scans(ctx, result, commands));
  return fg_text_append(ctx, commands,
                        " --model-out scanner.json\nfoilgauge measure --model scanner.json "
                        "NEXT_SCAN.png");
}

static fg_status tell_apart(fg_context *ctx, const fg_scan_result *result, char **words,
                            char **commands) {
  FG_TRY(fg_text_print(ctx, words, "Correct nothing by it yet, its cause is not known: %s.",
                       result->advices ? result->advice[0] : "scan again"));
  if (result->discs || result->same_foil) return FG_OK;
  FG_TRY(fg_text_append(ctx, commands, "foilgauge loop --same-foil"));
  for (size_t i = 0; i < result->scans && i < 1; i++)
    FG_TRY(fg_text_append_word(ctx, commands, result->scan[i].before->scan));
  return fg_text_append(ctx, commands, " TURNED_BY_90.png");
}

static fg_status correct_scanner(fg_context *ctx, const fg_scan_result *result, sources found,
                                 char **words, char **commands) {
  if (has_row_jumps(result))
    return fg_text_print(
        ctx, words,
        "Scan again without a pause (a smaller window, a lower resolution), and run the loop on "
        "that scan: the rows of this picture jump, as where the carriage stops. Other scans do not "
        "share that, so write no model of the scanner from it.");
  const fg_picture_words *spoiling = find_spoiling(result);
  if (spoiling)
    return fg_text_print(ctx, words,
                         "Scan again, and run the loop on that scan: a model of this picture would "
                         "carry what spoils "
                         "it to every scan (%s). %s",
                         spoiling->name, spoiling->cure);
  FG_TRY(fg_text_print(
      ctx, words,
      "Correct the scanner: what was found goes with the glass%s, so every scan of this scanner "
      "has it; write its model once, and measure with it%s.",
      found.part ? " (what the part does beside it is the die's or the press's to mend)" : "",
      found.curve ? ", after a second part on the same glass has shown the same curve" : ""));
  return correct_by_model(ctx, result, commands);
}

static const char *for_part(const fg_scan_result *result, sources found) {
  if (found.part && result->discs)
    return "Correct nothing by it: the discs' own shapes look like this, and so do edges that a "
           "scanner shifts by their direction; turn the discs by 90 degrees and scan again: a "
           "shape that turns with them is theirs. The dimensions stand as measured.";
  if (found.part)
    return "Correct the part, not the scanner: what was found turns with the foil, so look at the "
           "die, the press or how the foil was held; the dimensions stand as measured, since "
           "form is not subtracted.";
  if (found.width)
    return "Look at the sheet: its thickness changes along the strip; radii and heights of the "
           "midline stand.";
  if (has_deviating_land(result))
    return "Scan again without a pause, and look at the foil: a dent, a crease or rows that jump "
           "displace a part of it (land_deviates), so the bumps beside it are not measured right; "
           "the die may be sound.";
  return "Look at the die and the heat treatment: the bumps differ among themselves in a way that "
         "the declared model does not explain; the dimensions stand as measured.";
}

fg_status fg_scan_loop_next(fg_context *ctx, const fg_scan_result *result, char **words,
                            char **commands) {
  sources found = find_sources(result);
  *words = *commands = NULL;
  if (result->contradicted)
    return fg_text_print(ctx, words,
                         "Correct nothing by it: the scans kept aside become worse; scan the same "
                         "part at the same place of the glass again.");
  if (!result->named) return tell_apart(ctx, result, words, commands);
  if (found.scanner) return correct_scanner(ctx, result, found, words, commands);
  if (found.part || found.width || found.bumps)
    return fg_text_print(ctx, words, "%s", for_part(result, found));
  return fg_text_print(ctx, words, "Nothing to correct: use the dimensions as they were measured.");
}
