/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.qif: QIF 3.0 (ANSI/DMSC QIF 3.0, ISO 23952).
 *
 * It holds the Characteristics, and one set of MeasurementResults with its ActualComponent per
 * foil and per bearing that the manifest names. An ActualComponentSet holds the components of one
 * product: the bearing itself and its foils in order of the pads; foils in no bearing are a set of
 * their own. The component of a foil has the cells of the manifest (die, coil, operator, bearing
 * ...), its pad, its scan and the scan's SHA-256 as attributes; its date is the start of its
 * inspection. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "core/sha256.h"
#include "foilgauge/traceability.h"
#include "foilgauge/words.h"
#include "lot/run/date.h"
#include "page/page.h"
#include "report/lot/characteristics.h"
#include "report/lot/files.h"

typedef struct qif {
  FILE *out;
  const fg_lot_analysis *analysis;
  fg_characteristic *list;
  size_t count;
  fg_measured_part *parts;
  size_t part_count;
} qif;

/* Ids: definitions, nominals and items (`count` each), then per part a component, a set of results
 * and `count` measurements. */
static size_t item_id(const qif *q, size_t i) {
  return 2 * q->count + i + 1;
}

static size_t component_id(const qif *q, size_t part) {
  return 3 * q->count + part + 1;
}

static size_t results_id(const qif *q, size_t part) {
  return 3 * q->count + q->part_count + part * (q->count + 1) + 1;
}

static void put_qif_number(FILE *out, double value) {
  char text[32];
  fg_json_format(text, value);
  fputs(text, out);
}

/* Puts a UUID derived from the lot, so that the same lot has the same one. */
static void put_uuid(FILE *out, const char *a, const char *b) {
  char sum[65], both[160];
  snprintf(both, sizeof both, "%s %s", a, b);
  fg_sha256_text(both, sum);
  fprintf(out, "%.8s-%.4s-5%.3s-8%.3s-%.12s", sum, sum + 8, sum + 13, sum + 17, sum + 20);
}

static void put_qif_head(const qif *q) {
  const fg_lot *lot = q->analysis->lot;
  size_t last = results_id(q, q->part_count) - 1;
  fprintf(q->out,
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<QIFDocument "
          "xmlns=\"http://qifstandards.org/xsd/qif3\" idMax=\"%zu\" versionQIF=\"3.0.0\">\n<QPId>",
          last);
  put_uuid(q->out, lot->head.recipe_sha256, lot->head.manifest_sha256);
  fputs("</QPId>\n<Header><Application><Name>foilgauge</Name></Application></Header>\n"
        "<FileUnits><PrimaryUnits>\n<AngularUnit><SIUnitName>radian</SIUnitName><UnitName>degree"
        "</UnitName><UnitConversion><Factor>0.017453292519943295</Factor></UnitConversion>"
        "</AngularUnit>\n<LinearUnit><SIUnitName>meter</SIUnitName><UnitName>mm</UnitName>"
        "<UnitConversion><Factor>0.001</Factor></UnitConversion></LinearUnit>\n</PrimaryUnits>"
        "</FileUnits>\n",
        q->out);
}

static void put_tolerance(FILE *out, const fg_tolerance *tolerance) {
  if (!tolerance) {
    fputs("<NonTolerance>MEASURED</NonTolerance>", out);
    return;
  }
  fputs("<Tolerance>", out);
  if (isfinite(tolerance->upper)) {
    fputs("<MaxValue>", out);
    put_qif_number(out, tolerance->upper);
    fputs("</MaxValue>", out);
  }
  if (isfinite(tolerance->lower)) {
    fputs("<MinValue>", out);
    put_qif_number(out, tolerance->lower);
    fputs("</MinValue>", out);
  }
  fputs("<DefinedAsLimit>true</DefinedAsLimit></Tolerance>", out);
}

static void put_qif_name(FILE *out, const fg_lot_words *words, const fg_characteristic *one) {
  if (one->owner == FG_QUANTITY_OF_BEARING) fputs("bearing: ", out);
  fputs(one->row->words, out);
  if (one->number) fprintf(out, "%s%d", words->before_number, one->number);
}

static void put_characteristics(const qif *q) {
  fprintf(q->out, "<Characteristics>\n<CharacteristicDefinitions n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out, "<%sCharacteristicDefinition id=\"%zu\">", q->list[i].row->characteristic,
            i + 1);
    put_tolerance(q->out, q->list[i].tolerance);
    fprintf(q->out, "</%sCharacteristicDefinition>\n", q->list[i].row->characteristic);
  }
  fprintf(q->out, "</CharacteristicDefinitions>\n<CharacteristicNominals n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out,
            "<%sCharacteristicNominal id=\"%zu\"><CharacteristicDefinitionId>%zu"
            "</CharacteristicDefinitionId><TargetValue>",
            q->list[i].row->characteristic, q->count + i + 1, i + 1);
    put_qif_number(q->out, q->list[i].nominal);
    fprintf(q->out, "</TargetValue></%sCharacteristicNominal>\n", q->list[i].row->characteristic);
  }
  fprintf(q->out, "</CharacteristicNominals>\n<CharacteristicItems n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out, "<%sCharacteristicItem id=\"%zu\"><Name>", q->list[i].row->characteristic,
            item_id(q, i));
    put_qif_name(q->out, fg_lot_words_of(q->analysis), &q->list[i]);
    fprintf(q->out,
            "</Name><CharacteristicNominalId>%zu</CharacteristicNominalId>"
            "</%sCharacteristicItem>\n",
            q->count + i + 1, q->list[i].row->characteristic);
  }
  fputs("</CharacteristicItems>\n</Characteristics>\n", q->out);
}

static const char *characteristic_status(fg_verdict verdict) {
  switch (verdict) {
  case FG_VERDICT_PASS:
    return "PASS";
  case FG_VERDICT_FAIL:
    return "FAIL";
  case FG_VERDICT_UNDECIDED:
    return "INDETERMINATE";
  default:
    return "NOT_ANALYZED";
  }
}

static const char *inspection_status(fg_verdict verdict) {
  switch (verdict) {
  case FG_VERDICT_PASS:
    return "PASS";
  case FG_VERDICT_FAIL:
    return "FAIL";
  case FG_VERDICT_NOT_MEASURED:
    return "NOT_MEASURED";
  default:
    return "UNKNOWN";
  }
}

static void put_qif_measurement(const qif *q, size_t id, size_t i, double value, double u) {
  const fg_characteristic *one = &q->list[i];
  const fg_tolerance *tolerance = one->tolerance;
  fg_verdict verdict = tolerance ? fg_judge_measured(&q->analysis->lot->settings.design, tolerance,
                                                     one->row, value, u)
                                 : FG_VERDICT_NONE;
  fprintf(q->out,
          "<%sCharacteristicMeasurement id=\"%zu\"><Status><CharacteristicStatusEnum>%s"
          "</CharacteristicStatusEnum></Status><CharacteristicItemId>%zu</CharacteristicItemId>"
          "<Value",
          one->row->characteristic, id, characteristic_status(verdict), item_id(q, i));
  if (isfinite(u)) {
    fputs(" combinedUncertainty=\"", q->out);
    put_qif_number(q->out, u);
    fputs("\"", q->out);
  }
  fputs(">", q->out);
  put_qif_number(q->out, value);
  fprintf(q->out, "</Value></%sCharacteristicMeasurement>\n", one->row->characteristic);
}

/* Puts the date as xs:dateTime. One without a zone stays without: nothing says which it is. */
static void put_inspection_start(const qif *q, const fg_lot_foil *foil) {
  const char *text = fg_lot_date_of(q->analysis->lot, foil->item);
  double days = fg_date_days(text);
  char date[FG_DATE_UTC];
  struct tm when;
  if (!isfinite(days)) return;
  time_t seconds = (time_t)llround(days * 86400);
  if (!gmtime_r(&seconds, &when)) return;
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &when);
  fprintf(q->out,
          "<InspectionTraceability><InspectionStart>%s%s</InspectionStart></InspectionTraceability>"
          "\n",
          date, fg_date_is_utc(text) ? "Z" : "");
}

static fg_verdict find_part_verdict(const fg_measured_part *part) {
  return part->foil ? part->foil->verdict : part->bearing->decision.outcome.verdict;
}

static void put_part_results(const qif *q, size_t index) {
  const fg_measured_part *part = &q->parts[index];
  size_t id = results_id(q, index), known = 0;
  double u;
  for (size_t i = 0; i < q->count; i++)
    known += isfinite(fg_characteristic_value(&q->list[i], part, &u)) != 0;
  fprintf(q->out, "<MeasurementResults id=\"%zu\">\n", id);
  if (part->foil) put_inspection_start(q, part->foil);
  if (known) {
    fprintf(q->out, "<MeasuredCharacteristics><CharacteristicMeasurements n=\"%zu\">\n", known);
    for (size_t i = 0; i < q->count; i++) {
      double value = fg_characteristic_value(&q->list[i], part, &u);
      if (isfinite(value)) put_qif_measurement(q, id + 1 + i, i, value, u);
    }
    fputs("</CharacteristicMeasurements></MeasuredCharacteristics>\n", q->out);
  }
  fprintf(q->out,
          "<InspectionStatus><InspectionStatusEnum>%s</InspectionStatusEnum></InspectionStatus>"
          "<ActualComponentIds n=\"1\"><Id>%zu</Id></ActualComponentIds>\n</MeasurementResults>\n",
          inspection_status(find_part_verdict(part)), component_id(q, index));
}

static void put_attribute(FILE *out, const char *name, const char *value) {
  fputs("<AttributeStr name=\"", out);
  fg_html_text(out, name);
  fputs("\" value=\"", out);
  fg_html_text(out, value);
  fputs("\"/>", out);
}

/* Puts the cells of the manifest that are not empty, and the origin of the foil. */
static void put_attributes(const qif *q, const fg_measured_part *part) {
  const fg_manifest *manifest = &q->analysis->lot->manifest;
  char traced[FG_TRACEABILITY_SENTENCE];
  size_t item = part->foil->item, count = 3;
  bool pad =
      part->bearing &&
      *fg_manifest_cell(manifest, item,
                        fg_manifest_column(manifest, q->analysis->lot->settings.pad_column)) == 0;
  char number[24];
  for (size_t i = 1; i < manifest->columns; i++)
    count += *fg_manifest_cell(manifest, item, i) != 0;
  fprintf(q->out, "<Attributes n=\"%zu\">", count + pad);
  for (size_t i = 1; i < manifest->columns; i++)
    if (*fg_manifest_cell(manifest, item, i))
      put_attribute(q->out, manifest->name[i], fg_manifest_cell(manifest, item, i));
  snprintf(number, sizeof number, "%zu", part->pad + 1);
  if (pad) put_attribute(q->out, "pad", number);
  put_attribute(q->out, "scan", fg_manifest_scan(manifest, item));
  put_attribute(q->out, "scan_sha256", q->analysis->lot->records[item].sha256);
  fg_traceability_sentence(&q->analysis->lot->settings.design, traced, sizeof traced);
  put_attribute(q->out, "traceability", traced);
  fputs("</Attributes>", q->out);
}

static void put_component(const qif *q, size_t index) {
  const fg_measured_part *part = &q->parts[index];
  fprintf(q->out, "<ActualComponent id=\"%zu\">", component_id(q, index));
  if (part->foil) {
    put_attributes(q, part);
    fputs("<SerialNumber>", q->out);
    fg_html_text(q->out, fg_manifest_label(&q->analysis->lot->manifest, part->foil->item));
    if (q->analysis->lot->records[part->foil->item].foil_count > 1)
      fprintf(q->out, " #%d", part->foil->foil->number);
  } else {
    fputs("<Attributes n=\"1\"><AttributeStr name=\"assembly\" value=\"bearing\"/></Attributes>"
          "<SerialNumber>",
          q->out);
    fg_html_text(q->out, part->bearing->name);
  }
  fprintf(q->out,
          "</SerialNumber><Status><InspectionStatusEnum>%s</InspectionStatusEnum></Status>"
          "</ActualComponent>\n",
          inspection_status(find_part_verdict(part)));
}

/* Returns the number of parts from this one on that belong to one product. */
static size_t product_size(const qif *q, size_t first) {
  size_t end = first + 1;
  while (end < q->part_count && q->parts[end].bearing == q->parts[first].bearing)
    end++;
  return end - first;
}

static void put_components(const qif *q) {
  size_t sets = 0, size;
  for (size_t i = 0; i < q->part_count; i += product_size(q, i))
    sets++;
  fprintf(q->out, "<ActualComponentSets n=\"%zu\">", sets);
  for (size_t first = 0; first < q->part_count; first += size) {
    size = product_size(q, first);
    fprintf(q->out, "<ActualComponentSet n=\"%zu\">\n", size);
    for (size_t i = 0; i < size; i++)
      put_component(q, first + i);
    fputs("</ActualComponentSet>", q->out);
  }
  fputs("</ActualComponentSets>\n", q->out);
}

static void put_results(const qif *q) {
  if (!q->part_count) return;
  fprintf(q->out, "<Results>\n<MeasurementResultsSet n=\"%zu\">\n", q->part_count);
  for (size_t i = 0; i < q->part_count; i++)
    put_part_results(q, i);
  fputs("</MeasurementResultsSet>\n", q->out);
  put_components(q);
  fputs("</Results>\n", q->out);
}

fg_status fg_lot_write_qif(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  qif q = {.out = out, .analysis = analysis};
  fg_status status = fg_characteristics_list(ctx, analysis, &q.list, &q.count);
  if (status == FG_OK) status = fg_measured_parts_list(ctx, analysis, &q.parts, &q.part_count);
  if (status == FG_OK) {
    put_qif_head(&q);
    if (q.count) put_characteristics(&q);
    if (q.count) put_results(&q);
    fputs("</QIFDocument>\n", out);
    status = fg_stream_finish(ctx, out, "results.qif");
  }
  free(q.parts);
  free(q.list);
  return status;
}
