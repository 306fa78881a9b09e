/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots that were held against the prediction of their die (expected.json in their folders): the
 * history of the law of springback, lot by lot. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "lots/index.h"
#include "lots/members.h"
#include "page/table.h"

enum { EXPECTED_BYTES = 64 << 20 };

static double number_of(const cJSON *object, const char *name) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(object, name);
  return cJSON_IsNumber(value) ? value->valuedouble : NAN;
}

static void fill_prediction(const cJSON *root, fg_index_prediction *prediction) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  const cJSON *law = cJSON_GetObjectItemCaseSensitive(root, "law");
  const cJSON *radius = cJSON_GetObjectItemCaseSensitive(law, "radius");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/expected/1") != 0) return;
  *prediction = (fg_index_prediction){
      .known = true,
      .error_before_pct = number_of(root, "error_before_pct"),
      .error_after_pct = number_of(root, "error_after_pct"),
      .p_value = number_of(root, "p_value"),
      .springback_pct = number_of(radius, "springback_pct"),
      .u_springback_pct = number_of(radius, "u_springback_pct"),
      .inside = (size_t)fmax(0, number_of(root, "inside")),
      .values = (size_t)fmax(0, number_of(root, "values")),
  };
}

fg_status fg_index_read_prediction(fg_context *ctx, fg_index_lot *lot) {
  char *path, *text = NULL;
  cJSON *root = NULL;
  fg_context inner = {.message = ""};
  FG_TRY(fg_lot_path(ctx, lot->folder, "expected.json", &path));
  /* Most lots have none; one that cannot be read says nothing. */
  if (fg_file_read_text(&inner, path, EXPECTED_BYTES, &text) == FG_OK &&
      fg_json_read(&inner, path, text, &root) == FG_OK)
    fill_prediction(root, &lot->prediction);
  cJSON_Delete(root);
  free(text);
  free(path);
  return FG_OK;
}

static const fg_member prediction_rows[] = {
    {FG_NUMBER("error_before_pct", fg_index_prediction, error_before_pct),
     .words = "error of the bump radii of the lot before, rms over the bumps",
     .page = {.rank = 2, .heading = "error before,\n%", .decimals = 3}},
    {FG_NUMBER("error_after_pct", fg_index_prediction, error_after_pct), .words = "of this lot",
     .page = {.rank = 3, .heading = "after,\n%", .decimals = 3}},
    {FG_COUNT("inside", fg_index_prediction, inside), .words = "values in their intervals of 95 %",
     .page = {.rank = 4, .heading = "inside"}},
    {FG_COUNT("values", fg_index_prediction, values), .words = "held against the prediction",
     .page = {.rank = 5, .heading = "of"}},
    {FG_NUMBER("p_value", fg_index_prediction, p_value),
     .words = "that a lot as predicted is as far off in all radii",
     .page = {.rank = 6, .heading = "p", .decimals = 3}},
    {FG_NUMBER_U("springback_pct", fg_index_prediction, springback_pct, u_springback_pct),
     .words = "100 ln(formed / die) of the radius by the law with this lot",
     .page = {.rank = 7, .heading = "law: springback,\n%", .decimals = 3}},
};
const fg_members fg_index_prediction_members = FG_MEMBERS_DEFINED(prediction_rows, "prediction");

static const char *find_predicted_lot(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_index *)subject->whole)->lots[subject->index].name;
}

static const fg_member table_rows[] = {
    {FG_TEXT_BY("name", find_predicted_lot), .page = {.rank = 1, .heading = "lot", .words = true}},
    {FG_SAME(&fg_index_prediction_members)},
};
static const fg_members table_members = FG_INDEX_TABLE(table_rows, NULL, NULL);

static bool find_prediction(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_index *index = list->whole;
  element->object =
      i < index->read && index->lots[i].prediction.known ? &index->lots[i].prediction : NULL;
  return i < index->read;
}

void fg_index_put_predictions(FILE *out, const fg_index *index) {
  size_t known = 0;
  for (size_t i = 0; i < index->read; i++)
    known += index->lots[i].prediction.known;
  if (!known) return;
  fputs("<section class=\"part\">\n<h1>Dies, and whether their predictions were right</h1>\n", out);
  fg_html_table(out, &table_members, &(fg_subject){.object = index, .whole = index},
                find_prediction);
  fputs("<p class=\"note\">Of lots that were held against the report of their die "
        "(`foilgauge lot --expected`). The last column is the history of the law: its springback "
        "with every lot up to that one.</p>\n</section>\n",
        out);
}
