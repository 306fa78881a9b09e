/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON schemas of documents, from the rows of their members. */
#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "manual/documents.h"

typedef struct schema {
  const char *file;
  cJSON *definitions;
  bool is_read; /* people write the document */
} schema;

/* The program ends without memory, as any tool of a build does. */
static cJSON *need(cJSON *item) {
  if (!item) abort();
  return item;
}

static void add_item(cJSON *object, const char *name, cJSON *item) {
  cJSON_AddItemToObject(object, name, need(item));
}

static void add_type(cJSON *object, const char *type, bool nullable) {
  const char *const types[] = {type, "null"};
  add_item(object, "type", nullable ? cJSON_CreateStringArray(types, 2) : cJSON_CreateString(type));
}

static void move_items(cJSON *from, cJSON *to) {
  while (from->child) {
    cJSON *child = cJSON_DetachItemViaPointer(from, from->child);
    char *name = child->string;
    child->string = NULL;
    add_item(to, name, child);
    free(name);
  }
  cJSON_Delete(from);
}

static void add_words(cJSON *object, const fg_member *row) {
  if (row->words) add_item(object, "description", cJSON_CreateString(row->words));
}

static void describe_members(schema *all, const fg_members *members, cJSON *properties,
                             cJSON *required, bool optional);

/* Makes the schema of an object; `row` NULL: of an element. */
static cJSON *make_object(schema *all, const fg_members *members, const fg_member *row,
                          bool nullable) {
  cJSON *object = need(cJSON_CreateObject()), *properties = need(cJSON_CreateObject()),
        *required = need(cJSON_CreateArray());
  if (row) add_words(object, row);
  add_type(object, "object", nullable);
  add_item(object, "properties", properties);
  add_item(object, "required", required);
  add_item(object, "additionalProperties", cJSON_CreateFalse());
  describe_members(all, members, properties, required, false);
  if (members->limits) move_items(need(cJSON_Parse(members->limits)), object);
  return object;
}

static cJSON *make_member(schema *all, const fg_member *row);

/* Makes the schema of a list's element, by reference where it has a definition. */
static cJSON *make_element(schema *all, const fg_members *members) {
  char place[200];
  if (members->count == 1 && !members->rows[0].name && members->rows[0].kind != FG_MEMBER_SAME)
    return make_member(all, &members->rows[0]);
  if (!members->definition) return make_object(all, members, NULL, false);
  bool own = !members->file || !strcmp(members->file, all->file);
  if (own && !cJSON_GetObjectItem(all->definitions, members->definition)) {
    add_item(all->definitions, members->definition,
             cJSON_CreateObject()); /* it may refer to itself */
    cJSON *made = make_object(all, members, NULL, members->nullable);
    cJSON_ReplaceItemInObject(all->definitions, members->definition, made);
  }
  snprintf(place, sizeof place, "%s%s#/$defs/%s", own ? "" : members->file,
           own ? "" : ".schema.json", members->definition);
  cJSON *reference = need(cJSON_CreateObject());
  add_item(reference, "$ref", cJSON_CreateString(place));
  return reference;
}

static cJSON *make_part(schema *all, const fg_member *row) {
  bool nullable = (row->part || row->pointed || row->options & FG_MEMBER_NULLABLE) &&
                  !(row->options & (FG_MEMBER_LEFT_OUT | FG_MEMBER_NEVER_NULL));
  if (!row->members->definition) return make_object(all, row->members, row, nullable);
  cJSON *element = make_element(all, row->members);
  if (!nullable || row->members->nullable) {
    add_words(element, row);
    return element;
  }
  cJSON *either = need(cJSON_CreateObject()), *choices = need(cJSON_CreateArray()),
        *null = need(cJSON_CreateObject());
  add_words(either, row);
  add_item(either, "anyOf", choices);
  add_type(null, "null", false);
  cJSON_AddItemToArray(choices, element);
  cJSON_AddItemToArray(choices, null);
  return either;
}

/* Word `i` that a member can be or have as a name; NULL behind the last. */
static const char *choice_of(const fg_member *row, size_t i) {
  return row->choice_at ? row->choice_at(i) : row->choices ? row->choices[i] : NULL;
}

static cJSON *make_list(schema *all, const fg_member *row) {
  cJSON *list = need(cJSON_CreateObject());
  bool map = row->kind == FG_MEMBER_MAP;
  add_words(list, row);
  add_type(list, map ? "object" : "array", false);
  cJSON *known = map && choice_of(row, 0) ? need(cJSON_CreateObject()) : NULL;
  for (size_t i = 0; known && choice_of(row, i); i++)
    add_item(known, choice_of(row, i), make_element(all, row->members));
  if (known) {
    cJSON *names = need(cJSON_CreateArray());
    for (size_t i = 0; choice_of(row, i); i++)
      cJSON_AddItemToArray(names, need(cJSON_CreateString(choice_of(row, i))));
    add_item(list, "properties", known);
    add_item(list, "required", names);
    add_item(list, "additionalProperties", cJSON_CreateFalse());
  } else {
    cJSON *element = make_element(all, row->members);
    if (row->options & FG_MEMBER_NOT_EMPTY)
      add_item(element, "minProperties", cJSON_CreateNumber(1));
    add_item(list, map ? "additionalProperties" : "items", element);
  }
  if (row->lowest > 0)
    add_item(list, map ? "minProperties" : "minItems", cJSON_CreateNumber(row->lowest));
  if (row->highest > 0)
    add_item(list, map ? "maxProperties" : "maxItems", cJSON_CreateNumber(row->highest));
  return list;
}

static cJSON *make_numbers(const fg_member *row, bool nullable, double min, double max) {
  cJSON *numbers = need(cJSON_CreateObject()), *items = need(cJSON_CreateObject());
  add_words(numbers, row);
  add_type(numbers, "array", row->kind == FG_MEMBER_NUMBERS && row->options & FG_MEMBER_NULLABLE);
  add_type(items, "number", nullable);
  add_item(numbers, "items", items);
  if (max <= 0) return numbers;
  add_item(numbers, "minItems", cJSON_CreateNumber(min));
  add_item(numbers, "maxItems", cJSON_CreateNumber(max));
  return numbers;
}

static void add_choices(cJSON *object, const fg_member *row, bool nullable) {
  if (fg_member_choice_at(row, 0) && !fg_member_choice_at(row, 1) && !nullable) {
    add_item(object, "const", cJSON_CreateString(fg_member_choice_at(row, 0)));
    return;
  }
  cJSON *choices = need(cJSON_CreateArray());
  for (size_t i = 0; choice_of(row, i); i++)
    cJSON_AddItemToArray(choices, need(cJSON_CreateString(choice_of(row, i))));
  if (nullable) cJSON_AddItemToArray(choices, need(cJSON_CreateNull()));
  add_item(object, "enum", choices);
}

static cJSON *make_text(const schema *all, const fg_member *row, bool with_words) {
  cJSON *text = need(cJSON_CreateObject());
  bool always =
      all->is_read || row->kind == FG_MEMBER_TEXT || (row->kind == FG_MEMBER_WORD && !row->word);
  bool nullable = (!always || row->options & FG_MEMBER_EMPTY_IS_NULL) &&
                  !(row->options & (FG_MEMBER_LEFT_OUT | FG_MEMBER_NEVER_NULL));
  if (with_words) add_words(text, row);
  if (row->choices || row->choice_at)
    add_choices(text, row, nullable);
  else
    add_type(text, "string", nullable);
  if (all->is_read && row->kind == FG_MEMBER_TEXT)
    add_item(text, "maxLength", cJSON_CreateNumber((double)row->stride - 1));
  if (row->pattern) add_item(text, "pattern", cJSON_CreateString(row->pattern));
  return text;
}

static cJSON *make_texts(const fg_member *row) {
  cJSON *texts = need(cJSON_CreateObject()), *items = need(cJSON_CreateObject());
  add_words(texts, row);
  add_type(texts, "array", false);
  if (row->choices || row->choice_at)
    add_choices(items, row, false);
  else
    add_type(items, "string", false);
  add_item(texts, "items", items);
  if (choice_of(row, 0)) add_item(texts, "uniqueItems", cJSON_CreateTrue());
  if (row->lowest > 0) add_item(texts, "minItems", cJSON_CreateNumber(row->lowest));
  return texts;
}

static cJSON *make_number(const schema *all, const fg_member *row) {
  cJSON *number = need(cJSON_CreateObject());
  bool whole = row->kind != FG_MEMBER_NUMBER && row->kind != FG_MEMBER_FLAG;
  unsigned never = FG_MEMBER_LEFT_OUT | FG_MEMBER_NEVER_NULL;
  unsigned null = FG_MEMBER_NULLABLE | FG_MEMBER_EMPTY_IS_NULL;
  unsigned only_true = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL;
  bool nullable = row->kind == FG_MEMBER_NUMBER && !all->is_read
                      ? !(row->options & never)
                      : (row->options & null) && !(row->options & never);
  const char *type = row->kind == FG_MEMBER_FLAG ? "boolean" : whole ? "integer" : "number";
  add_words(number, row);
  if (row->kind == FG_MEMBER_FLAG && (row->options & only_true) == only_true) {
    add_item(number, "const", cJSON_CreateTrue());
    return number;
  }
  add_type(number, type, nullable);
  if (row->options & FG_MEMBER_ABOVE_0) add_item(number, "exclusiveMinimum", cJSON_CreateNumber(0));
  if (row->highest > row->lowest) {
    add_item(number, "minimum", cJSON_CreateNumber(row->lowest));
    add_item(number, "maximum", cJSON_CreateNumber(row->highest));
  } else if (row->lowest > 0) {
    add_item(number, "minimum", cJSON_CreateNumber(row->lowest));
  } else if (row->options & FG_MEMBER_NOT_NEGATIVE || row->kind == FG_MEMBER_COUNT ||
             row->kind == FG_MEMBER_UNSIGNED || row->kind == FG_MEMBER_SEED) {
    add_item(number, "minimum", cJSON_CreateNumber(0));
  }
  return number;
}

static cJSON *make_by_text(const fg_member *row) {
  cJSON *made = need(cJSON_Parse(row->schema));
  if (row->words && !cJSON_GetObjectItem(made, "description")) add_words(made, row);
  return made;
}

static cJSON *make_member(schema *all, const fg_member *row) {
  if (row->schema) return make_by_text(row);
  switch (row->kind) {
  case FG_MEMBER_OBJECT:
    return make_part(all, row);
  case FG_MEMBER_LIST:
  case FG_MEMBER_MAP:
    return make_list(all, row);
  case FG_MEMBER_RANGE:
  case FG_MEMBER_PAIR:
    return make_numbers(row, !(row->options & FG_MEMBER_NEVER_NULL), 2, 2);
  case FG_MEMBER_NUMBERS:
    return make_numbers(row, !(row->options & FG_MEMBER_NEVER_NULL), row->lowest, row->highest);
  case FG_MEMBER_TEXTS:
    return make_texts(row);
  case FG_MEMBER_TEXT:
  case FG_MEMBER_STRING:
  case FG_MEMBER_WORD:
    return make_text(all, row, true);
  default:
    return make_number(all, row);
  }
}

static void put_property(cJSON *properties, cJSON *required, const char *name, cJSON *made,
                         bool optional) {
  if (cJSON_GetObjectItemCaseSensitive(properties, name)) { /* a row for each case */
    cJSON_Delete(made);
    return;
  }
  add_item(properties, name, made);
  if (!optional) cJSON_AddItemToArray(required, need(cJSON_CreateString(name)));
}

/* Adds a case to the property of this name. */
static void put_either(cJSON *properties, const char *name, cJSON *made) {
  cJSON *before = cJSON_DetachItemFromObjectCaseSensitive(properties, name);
  cJSON *cases = cJSON_GetObjectItemCaseSensitive(before, "anyOf"), *either = before;
  if (!cases) {
    either = need(cJSON_CreateObject());
    cases = need(cJSON_CreateArray());
    cJSON_AddItemToArray(cases, need(before));
    add_item(either, "anyOf", cases);
  }
  cJSON_AddItemToArray(cases, made);
  add_item(properties, name, either);
}

static void put_uncertainty(const fg_member *row, const char *before, cJSON *properties,
                            cJSON *required, bool optional) {
  char name[200];
  cJSON *u = need(cJSON_CreateObject());
  snprintf(name, sizeof name, "%s%s", before, row->name);
  add_type(u, "number", true);
  add_item(u, "minimum", cJSON_CreateNumber(0));
  put_property(properties, required, name, u, optional);
}

static void describe_head(const schema *all, const fg_member *row, cJSON *properties,
                          cJSON *required) {
  cJSON *name = need(cJSON_CreateObject()), *version = need(cJSON_CreateObject());
  add_item(name, "const", cJSON_CreateString(row->name));
  put_property(properties, required, "schema", name, false);
  if (row->options & FG_MEMBER_NO_VERSION) {
    cJSON_Delete(version);
    return;
  }
  add_type(version, "string", false);
  put_property(properties, required, "version", version, all->is_read);
}

static void describe_row(schema *all, const fg_member *row, cJSON *properties, cJSON *required,
                         bool optional) {
  if (row->options & FG_MEMBER_NOT_IN_JSON) return;
  if (row->kind == FG_MEMBER_HEAD) {
    describe_head(all, row, properties, required);
    return;
  }
  optional = optional || row->present || row->options & FG_MEMBER_LEFT_OUT;
  if (all->is_read) optional = !(row->options & FG_MEMBER_REQUIRED);
  if (row->options & FG_MEMBER_EITHER && cJSON_GetObjectItemCaseSensitive(properties, row->name)) {
    put_either(properties, row->name, make_member(all, row));
    return;
  }
  if (row->kind == FG_MEMBER_SAME) {
    fg_member each;
    for (size_t i = 0; row->row_at && row->row_at(i, &each); i++)
      describe_row(all, &each, properties, required, optional);
    if (row->members)
      describe_members(all, row->members, properties, required,
                       optional || (row->part && !(row->options & FG_MEMBER_NEVER_NULL)));
    return;
  }
  if (row->kind == FG_MEMBER_MAP && !row->name) {
    for (size_t i = 0; choice_of(row, i); i++)
      put_property(properties, required, choice_of(row, i), make_element(all, row->members),
                   optional);
    return;
  }
  put_property(properties, required, row->name, make_member(all, row), optional);
  if (row->sd_offset) put_uncertainty(row, "sd_", properties, required, optional);
  if (fg_member_has_u(row)) put_uncertainty(row, "u_", properties, required, optional);
  if (row->repeat_offset) put_uncertainty(row, "u_repeat_", properties, required, optional);
  if (row->kind == FG_MEMBER_PAIR && row->u_offset) {
    const fg_member u = {.words = "their standard uncertainties"};
    char name[200];
    snprintf(name, sizeof name, "u_%s", row->name);
    put_property(properties, required, name, make_numbers(&u, true, 2, 2), optional);
  }
}

static void describe_members(schema *all, const fg_members *members, cJSON *properties,
                             cJSON *required, bool optional) {
  for (size_t i = 0; i < members->count; i++)
    describe_row(all, &members->rows[i], properties, required, optional);
}

/* Writes the tree; arrays of words stay on one line. */
static void write_tree(fg_json *json, const char *name, const cJSON *item) {
  bool line = cJSON_IsArray(item) && !cJSON_IsObject(item->child);
  if (cJSON_IsObject(item) || cJSON_IsArray(item)) {
    (cJSON_IsObject(item) ? fg_json_object : fg_json_array)(json, name);
    if (line) fg_json_line(json);
    for (const cJSON *child = item->child; child; child = child->next)
      write_tree(json, cJSON_IsObject(item) ? child->string : NULL, child);
    (cJSON_IsObject(item) ? fg_json_object_end : fg_json_array_end)(json);
    if (line) fg_json_line_end(json);
  } else if (cJSON_IsString(item) || cJSON_IsNull(item)) {
    fg_json_string(json, name, cJSON_IsNull(item) ? NULL : item->valuestring);
  } else if (cJSON_IsBool(item)) {
    fg_json_bool(json, name, cJSON_IsTrue(item));
  } else if (item->valuedouble == (double)(int64_t)item->valuedouble) {
    fg_json_integer(json, name, (int64_t)item->valuedouble);
  } else {
    fg_json_number(json, name, item->valuedouble);
  }
}

void fg_document_write_schema(const fg_document *document, FILE *out) {
  char id[200];
  fg_json json;
  schema all = {document->file, need(cJSON_CreateObject()), document->is_read};
  cJSON *root = need(cJSON_CreateObject());
  snprintf(id, sizeof id, "%s.schema.json", document->file);
  add_item(root, "$schema", cJSON_CreateString("https://json-schema.org/draft/2020-12/schema"));
  add_item(root, "$id", cJSON_CreateString(id));
  add_item(root, "title", cJSON_CreateString(document->title));
  if (document->description)
    add_item(root, "description", cJSON_CreateString(document->description));
  cJSON *object = make_object(&all, document->members, NULL, false);
  move_items(object, root);
  for (size_t i = 0; document->describes && document->describes[i]; i++)
    cJSON_Delete(make_element(&all, document->describes[i]));
  if (all.definitions->child)
    add_item(root, "$defs", all.definitions);
  else
    cJSON_Delete(all.definitions);
  fg_json_begin(&json, out);
  write_tree(&json, NULL, root);
  fg_json_end(&json);
  cJSON_Delete(root);
}
