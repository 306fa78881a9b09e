/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model file: the declared model, the effects found, and their subtraction from another table. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/loop_model.h"

/* Coordinate as in the effect's own data: its range scales the basis. */
typedef struct model_coordinate {
  const char *name;
  double low, high, kelvin_offset;
  const cJSON *levels; /* words, or NULL */
  const cJSON *few;    /* distinct numbers of a factor, or NULL */
  size_t distinct;
} model_coordinate;

struct fg_loop_model {
  cJSON *json; /* owns every text below */
  const char *path;
  char *owned_path;
  const char *response, *formula;
};

static fg_status wrong(fg_context *ctx, const fg_loop_model *model, const char *what) {
  return fg_fail(ctx, FG_ERR_DATA, "%s: %s; write it anew with `foilgauge loop --model-out`",
                 model->path, what);
}

static fg_status get_text(fg_context *ctx, const fg_loop_model *model, const cJSON *object,
                          const char *name, const char **text) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!cJSON_IsString(item)) return wrong(ctx, model, "a text is missing");
  *text = item->valuestring;
  return FG_OK;
}

static fg_status get_number(fg_context *ctx, const fg_loop_model *model, const cJSON *object,
                            const char *name, double *value) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!cJSON_IsNumber(item)) return wrong(ctx, model, "a number is missing");
  *value = item->valuedouble;
  return FG_OK;
}

fg_status fg_loop_model_load(fg_context *ctx, const char *path, fg_loop_model **out) {
  fg_loop_model *model = NULL;
  const char *schema = NULL;
  char *text = NULL;
  const cJSON *declared;
  fg_status status = FG_OK;
  *out = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *model, (void **)&model));
  FG_TRY_EXIT(fg_text_print(ctx, &model->owned_path, "%s", path));
  model->path = model->owned_path;
  FG_TRY_EXIT(fg_file_read_text(ctx, path, 1 << 24, &text));
  FG_TRY_EXIT(fg_json_read(ctx, path, text, &model->json));
  if (!cJSON_IsObject(model->json)) {
    status = wrong(ctx, model, "not a JSON object");
    goto exit;
  }
  FG_TRY_EXIT(get_text(ctx, model, model->json, "schema", &schema));
  if (strcmp(schema, "foilgauge/loop-model/1")) {
    status = wrong(ctx, model, "the schema is not foilgauge/loop-model/1");
    goto exit;
  }
  declared = cJSON_GetObjectItemCaseSensitive(model->json, "declared");
  FG_TRY_EXIT(get_text(ctx, model, declared, "response", &model->response));
  FG_TRY_EXIT(get_text(ctx, model, declared, "model", &model->formula));
  if (!cJSON_IsArray(cJSON_GetObjectItemCaseSensitive(model->json, "claims")))
    status = wrong(ctx, model, "there are no claims");
exit:
  free(text);
  if (status == FG_OK)
    *out = model;
  else
    fg_loop_model_free(model);
  return status;
}

void fg_loop_model_free(fg_loop_model *model) {
  if (!model) return;
  cJSON_Delete(model->json);
  free(model->owned_path);
  free(model);
}

const char *fg_loop_model_response(const fg_loop_model *model) {
  return model->response;
}

const char *fg_loop_model_formula(const fg_loop_model *model) {
  return model->formula;
}

static fg_status read_coordinate(fg_context *ctx, const fg_loop_model *model, const cJSON *json,
                                 model_coordinate *at) {
  double distinct = 0;
  FG_TRY(get_text(ctx, model, json, "name", &at->name));
  FG_TRY(get_number(ctx, model, json, "low", &at->low));
  FG_TRY(get_number(ctx, model, json, "high", &at->high));
  FG_TRY(get_number(ctx, model, json, "kelvin_offset", &at->kelvin_offset));
  FG_TRY(get_number(ctx, model, json, "distinct", &distinct));
  at->distinct = distinct >= 0 && distinct < 1e9 ? (size_t)distinct : 0;
  at->levels = cJSON_GetObjectItemCaseSensitive(json, "levels");
  at->few = cJSON_GetObjectItemCaseSensitive(json, "values");
  if (!cJSON_IsArray(at->levels)) at->levels = NULL;
  if (!cJSON_IsArray(at->few)) at->few = NULL;
  return FG_OK;
}

static fg_status unseen(fg_context *ctx, const fg_loop_model *model, const model_coordinate *at,
                        size_t row, const char *what) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: row %zu: %s is %s; the model has seen %g to %g. Leave the row out, or close "
                 "the loop on data that hold it",
                 model->path, row + 1, at->name, what, at->low, at->high);
}

static fg_status fill_numbers(fg_context *ctx, const fg_loop_model *model, const fg_table *table,
                              const model_coordinate *from, fg_loop_coordinate *at) {
  const fg_extended *numbers;
  char text[32];
  double margin = 1e-9 * (from->high - from->low);
  FG_TRY(fg_table_numbers(ctx, table, from->name, &numbers));
  for (size_t i = 0; i < table->rows; i++) {
    at->value[i] = numbers[i].value;
    if (at->value[i] >= from->low - margin && at->value[i] <= from->high + margin) continue;
    fg_text_clip(text, sizeof text, "%g", at->value[i]);
    return unseen(ctx, model, from, i, text);
  }
  return FG_OK;
}

static fg_status fill_words(fg_context *ctx, const fg_loop_model *model, const fg_table *table,
                            const model_coordinate *from, fg_loop_coordinate *at) {
  const fg_column *column;
  FG_TRY(fg_table_find(ctx, table, from->name, &column));
  for (size_t i = 0; i < table->rows; i++) {
    bool word = column->word && column->word[i] < column->word_count, known = false;
    const cJSON *level;
    size_t index = 0;
    cJSON_ArrayForEach(level, from->levels) {
      if (word && cJSON_IsString(level) &&
          !strcmp(level->valuestring, column->words[column->word[i]])) {
        at->value[i] = (double)index;
        known = true;
      }
      index++;
    }
    if (!known)
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: %s has a level that the model has not seen",
                     model->path, i + 1, from->name);
  }
  at->levels = (size_t)cJSON_GetArraySize(from->levels);
  return FG_OK;
}

/* Returns the orders of a cycle as bits; 0 without any. */
static uint64_t read_orders(const cJSON *json) {
  const cJSON *order;
  uint64_t orders = 0;
  cJSON_ArrayForEach(order, cJSON_GetObjectItemCaseSensitive(json, "orders")) {
    double k = cJSON_GetNumberValue(order);
    if (k >= 1 && k <= FG_LOOP_ORDER_MAX) orders |= (uint64_t)1 << ((size_t)k - 1);
  }
  return orders;
}

/* Computes the response's change by an effect, at coordinates found in the table by name. */
static fg_status apply_claim(fg_context *ctx, const fg_loop_model *model, const cJSON *json,
                             const fg_table *table, double *change) {
  const cJSON *coordinates = cJSON_GetObjectItemCaseSensitive(json, "coordinates");
  const cJSON *coefficients = cJSON_GetObjectItemCaseSensitive(json, "coefficients");
  const cJSON *shapes = cJSON_GetObjectItemCaseSensitive(json, "shape");
  const char *id = NULL;
  const fg_loop_effect *effect = fg_loop_table_effects();
  fg_loop_coordinate at[2];
  fg_loop_problem problem = {.rows = table->rows, .coordinate = at, .coordinates = 2};
  fg_loop_claim claim = {.candidate = {.b = 1}};
  double *values = NULL;
  fg_status status = FG_OK;
  memset(at, 0, sizeof at);
  FG_TRY_EXIT(get_text(ctx, model, json, "id", &id));
  while (effect->id && strcmp(effect->id, id))
    effect++;
  if (!effect->id) goto exit; /* effects of single rows belong to their own table */
  claim.candidate.effect = effect;
  claim.candidate.orders = read_orders(json);
  FG_TRY_EXIT(fg_memory_allocate(ctx, table->rows + 1, 3 * sizeof *values, (void **)&values));
  for (int k = 0; k < cJSON_GetArraySize(coordinates) && k < 2; k++) {
    model_coordinate from = {0};
    FG_TRY_EXIT(read_coordinate(ctx, model, cJSON_GetArrayItem(coordinates, k), &from));
    at[k].value = values + (size_t)k * table->rows;
    at[k].low = from.low;
    at[k].high = from.high;
    at[k].kelvin_offset = from.kelvin_offset;
    at[k].distinct = from.distinct;
    for (int v = 0; v < cJSON_GetArraySize(from.few) && v <= FG_LOOP_COLUMNS; v++)
      at[k].few[v] = cJSON_GetNumberValue(cJSON_GetArrayItem(from.few, v));
    FG_TRY_EXIT(from.levels ? fill_words(ctx, model, table, &from, &at[k])
                            : fill_numbers(ctx, model, table, &from, &at[k]));
  }
  if (!effect->pair) claim.candidate.b = 0;
  if (!at[0].value || (effect->pair && !at[1].value)) {
    status = wrong(ctx, model, "a claim lacks its coordinates");
    goto exit;
  }
  claim.columns = effect->columns(&problem, &claim.candidate);
  if (claim.columns > FG_LOOP_COLUMNS ||
      (size_t)cJSON_GetArraySize(coefficients) != claim.columns) {
    status = wrong(ctx, model, "a claim has another number of coefficients than its effect");
    goto exit;
  }
  for (size_t k = 0; k < claim.columns; k++)
    claim.coefficient[k] = cJSON_GetNumberValue(cJSON_GetArrayItem(coefficients, (int)k));
  for (size_t d = 0; d < effect->shapes; d++)
    claim.shape[d] = cJSON_GetNumberValue(cJSON_GetArrayItem(shapes, (int)d));
  FG_TRY_EXIT(fg_loop_claim_evaluate(ctx, &problem, &claim, values + 2 * table->rows));
  for (size_t i = 0; i < table->rows; i++)
    change[i] += values[2 * table->rows + i];
  for (size_t i = 0; i < table->rows; i++)
    if (!isfinite(change[i])) {
      status = wrong(ctx, model, "the numbers of a claim are not complete");
      goto exit;
    }
exit:
  free(values);
  return status;
}

static fg_status apply_curve(fg_context *ctx, const fg_loop_model *model, const cJSON *json,
                             const fg_table *table, double *change) {
  fg_loop_curve curve = {0};
  const cJSON *shape = cJSON_GetObjectItemCaseSensitive(json, "shape");
  const char *name = NULL;
  const fg_extended *numbers;
  fg_status status = FG_OK;
  int count = cJSON_GetArraySize(shape);
  FG_TRY(get_text(ctx, model, json, "coordinate", &name));
  FG_TRY(fg_table_numbers(ctx, table, name, &numbers));
  if (count < 2) return wrong(ctx, model, "the unattributed curve has no shape");
  FG_TRY(fg_memory_allocate(ctx, (size_t)count, sizeof *curve.shape, (void **)&curve.shape));
  for (int k = 0; k < count; k++)
    for (int d = 0; d < 2; d++)
      curve.shape[k][d] = cJSON_GetNumberValue(cJSON_GetArrayItem(cJSON_GetArrayItem(shape, k), d));
  curve.count = (size_t)count;
  model_coordinate range = {
      .name = name, .low = curve.shape[0][0], .high = curve.shape[count - 1][0]};
  for (size_t i = 0; i < table->rows && status == FG_OK; i++) {
    char text[32];
    double margin = 1e-9 * (range.high - range.low), value = numbers[i].value;
    fg_text_clip(text, sizeof text, "%g", value);
    if (!(value >= range.low - margin && value <= range.high + margin))
      status = unseen(ctx, model, &range, i, text);
    else
      change[i] += fg_loop_curve_at(&curve, value);
  }
  free(curve.shape);
  return status;
}

static double number_or(const cJSON *json, const char *name, double otherwise) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);
  return cJSON_IsNumber(item) ? item->valuedouble : otherwise;
}

/* "a trend with humidity"; an id that is not in the table of effects concerns single rows. */
static void describe_effect(const cJSON *json, fg_loop_taken *taken) {
  const cJSON *at = cJSON_GetObjectItemCaseSensitive(json, "coordinates");
  const cJSON *id = cJSON_GetObjectItemCaseSensitive(json, "id");
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(json, "name");
  const fg_loop_effect *effect = fg_loop_table_effects();
  const char *names[2] = {"", ""};
  for (int k = 0; k < 2; k++) {
    const cJSON *one = cJSON_GetObjectItemCaseSensitive(cJSON_GetArrayItem(at, k), "name");
    if (cJSON_IsString(one)) names[k] = one->valuestring;
  }
  fg_text_clip(taken->id, sizeof taken->id, "%s", cJSON_IsString(id) ? id->valuestring : "");
  while (effect->id && strcmp(effect->id, taken->id))
    effect++;
  taken->applied = effect->id != NULL;
  fg_text_clip(taken->column[0], FG_LOOP_NAME, "%s", names[0]);
  if (effect->pair) fg_text_clip(taken->column[1], FG_LOOP_NAME, "%s", names[1]);
  if (taken->applied)
    fg_text_clip(taken->words, sizeof taken->words, "%s %s%s%s", effect->words, names[0],
                 effect->pair ? " and " : "", effect->pair ? names[1] : "");
  else
    fg_text_clip(taken->words, sizeof taken->words, "%s",
                 cJSON_IsString(name) ? name->valuestring : taken->id);
  const cJSON *coefficients = cJSON_GetObjectItemCaseSensitive(json, "coefficients");
  taken->parameters =
      (size_t)cJSON_GetArraySize(coefficients) + (taken->applied ? effect->shapes : 0);
  const cJSON *sentence = cJSON_GetObjectItemCaseSensitive(json, "sentence");
  if (cJSON_IsString(sentence))
    fg_text_clip(taken->sentence, sizeof taken->sentence, "%s", sentence->valuestring);
  taken->amplitude = number_or(json, "amplitude", NAN);
  taken->u_amplitude = number_or(json, "u_amplitude", NAN);
}

/* A penalised curve has as many parameters as its effective dof; its uncertainty is that of so many
 * parameters estimated from so many rows. */
static void describe_curve(const fg_loop_model *model, const cJSON *json, size_t rows,
                           fg_loop_taken *taken) {
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(json, "coordinate");
  const cJSON *shape = cJSON_GetObjectItemCaseSensitive(json, "shape");
  double dof = number_or(json, "freedom", (double)cJSON_GetArraySize(shape));
  fg_text_clip(taken->id, sizeof taken->id, "unattributed");
  fg_text_clip(taken->words, sizeof taken->words, "a smooth curve over %s",
               cJSON_IsString(name) ? name->valuestring : "");
  taken->applied = true;
  if (cJSON_IsString(name)) fg_text_clip(taken->column[0], FG_LOOP_NAME, "%s", name->valuestring);
  taken->parameters = (size_t)ceil(dof);
  taken->amplitude = NAN;
  taken->u_amplitude = number_or(model->json, "noise_sd", NAN) * sqrt(dof / (double)rows);
}

/* Computes the last step's addition to the change, which `before` still lacks. */
static void measure_step(const double *change, double *before, size_t rows, fg_loop_taken *taken) {
  for (size_t i = 0; i < rows; i++) {
    double step = change[i] - before[i];
    taken->low = i ? fmin(taken->low, step) : step;
    taken->high = i ? fmax(taken->high, step) : step;
    before[i] = change[i];
  }
  if (isnan(taken->amplitude)) taken->amplitude = (taken->high - taken->low) / 2;
}

static fg_status subtract_all(fg_context *ctx, const fg_loop_model *model, const fg_table *table,
                              fg_loop_takings *out) {
  const cJSON *claims = cJSON_GetObjectItemCaseSensitive(model->json, "claims"), *claim;
  const cJSON *curve = cJSON_GetObjectItemCaseSensitive(model->json, "unattributed");
  size_t rows = table->rows, max = (size_t)cJSON_GetArraySize(claims) + 1;
  double *before = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, rows + 1, sizeof *out->change, (void **)&out->change));
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *out->one, (void **)&out->one));
  FG_TRY(fg_memory_allocate(ctx, rows + 1, sizeof *before, (void **)&before));
  cJSON_ArrayForEach(claim, claims) {
    FG_TRY_EXIT(apply_claim(ctx, model, claim, table, out->change));
    describe_effect(claim, &out->one[out->count]);
    measure_step(out->change, before, rows, &out->one[out->count++]);
  }
  if (cJSON_IsObject(curve)) {
    FG_TRY_EXIT(apply_curve(ctx, model, curve, table, out->change));
    describe_curve(model, curve, rows, &out->one[out->count]);
    measure_step(out->change, before, rows, &out->one[out->count++]);
  }
exit:
  free(before);
  return status;
}

fg_status fg_loop_model_take(fg_context *ctx, const fg_loop_model *model, fg_table *table,
                             fg_loop_takings *takings) {
  const fg_extended *response;
  *takings = (fg_loop_takings){0};
  FG_TRY(fg_table_numbers(ctx, table, model->response, &response));
  fg_status status = subtract_all(ctx, model, table, takings);
  for (size_t c = 0; status == FG_OK && c < table->columns; c++)
    for (size_t i = 0; !strcmp(table->column[c].name, model->response) && i < table->rows; i++) {
      fg_extended *number = &table->column[c].number[i];
      number->value = number->value + number->tail - takings->change[i];
      number->tail = 0;
    }
  if (status != FG_OK) fg_loop_takings_free(takings);
  return status;
}

void fg_loop_takings_free(fg_loop_takings *takings) {
  free(takings->one);
  free(takings->change);
  *takings = (fg_loop_takings){0};
}

fg_status fg_loop_model_apply(fg_context *ctx, const fg_loop_model *model, fg_table *table) {
  fg_loop_takings takings;
  FG_TRY(fg_loop_model_take(ctx, model, table, &takings));
  fg_loop_takings_free(&takings);
  return FG_OK;
}
