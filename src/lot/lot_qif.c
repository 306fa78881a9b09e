/* results.qif: QIF 3.0 (ANSI/DMSC QIF 3.0, ISO 23952): the Characteristics, and one set of
 * MeasurementResults per foil with its ActualComponent. What the manifest says of a foil (die,
 * coil, operator, bearing ...) are Attributes of the component; its date is when its inspection
 * started. Ids count up in the order of the file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/words.h"
#include "lot/characteristics.h"
#include "lot/lot_date.h"
#include "lot/writers.h"
#include "report/measure/measure_page_parts.h"

typedef struct qif {
  FILE *out;
  const fg_lot_analysis *analysis;
  fg_characteristic *list;
  size_t count;
} qif;

/* Ids: definitions, nominals, items (count each), then per foil one component, one set of results
 * and `count` measurements. */
static size_t item_id(const qif *q, size_t i) {
  return 2 * q->count + i + 1;
}

static size_t component_id(const qif *q, size_t foil) {
  return 3 * q->count + foil + 1;
}

static size_t results_id(const qif *q, size_t foil) {
  return 3 * q->count + q->analysis->foil_count + foil * (q->count + 1) + 1;
}

static void put_number(FILE *out, double value) {
  char text[32];
  fg_json_format(text, value);
  fputs(text, out);
}

/* A UUID out of what the lot is: the same lot has the same one. */
static void put_uuid(FILE *out, const char *a, const char *b) {
  char sum[65], both[160];
  snprintf(both, sizeof both, "%s %s", a, b);
  fg_lot_sum_text(both, sum);
  fprintf(out, "%.8s-%.4s-5%.3s-8%.3s-%.12s", sum, sum + 8, sum + 13, sum + 17, sum + 20);
}

static void put_head(const qif *q) {
  const fg_lot *lot = q->analysis->lot;
  size_t last = results_id(q, q->analysis->foil_count) - 1;
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
    put_number(out, tolerance->upper);
    fputs("</MaxValue>", out);
  }
  if (isfinite(tolerance->lower)) {
    fputs("<MinValue>", out);
    put_number(out, tolerance->lower);
    fputs("</MinValue>", out);
  }
  fputs("<DefinedAsLimit>true</DefinedAsLimit></Tolerance>", out);
}

static void put_name(FILE *out, const fg_lot_words *words, const fg_characteristic *one) {
  fputs(one->quantity->row->words, out);
  if (one->number) fprintf(out, "%s%d", words->before_number, one->number);
}

static void put_characteristics(const qif *q) {
  fprintf(q->out, "<Characteristics>\n<CharacteristicDefinitions n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out, "<%sCharacteristicDefinition id=\"%zu\">", q->list[i].kind, i + 1);
    put_tolerance(q->out, q->list[i].quantity->tolerance);
    fprintf(q->out, "</%sCharacteristicDefinition>\n", q->list[i].kind);
  }
  fprintf(q->out, "</CharacteristicDefinitions>\n<CharacteristicNominals n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out,
            "<%sCharacteristicNominal id=\"%zu\"><CharacteristicDefinitionId>%zu"
            "</CharacteristicDefinitionId><TargetValue>",
            q->list[i].kind, q->count + i + 1, i + 1);
    put_number(q->out, q->list[i].nominal);
    fprintf(q->out, "</TargetValue></%sCharacteristicNominal>\n", q->list[i].kind);
  }
  fprintf(q->out, "</CharacteristicNominals>\n<CharacteristicItems n=\"%zu\">\n", q->count);
  for (size_t i = 0; i < q->count; i++) {
    fprintf(q->out, "<%sCharacteristicItem id=\"%zu\"><Name>", q->list[i].kind, item_id(q, i));
    put_name(q->out, fg_lot_words_of(q->analysis), &q->list[i]);
    fprintf(q->out,
            "</Name><CharacteristicNominalId>%zu</CharacteristicNominalId>"
            "</%sCharacteristicItem>\n",
            q->count + i + 1, q->list[i].kind);
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

static void put_measurement(const qif *q, size_t id, size_t i, double value, double u) {
  const fg_characteristic *one = &q->list[i];
  const fg_tolerance *tolerance = one->quantity->tolerance;
  fg_verdict verdict = tolerance ? fg_judge_value(tolerance, value, u) : FG_VERDICT_NONE;
  fprintf(q->out,
          "<%sCharacteristicMeasurement id=\"%zu\"><Status><CharacteristicStatusEnum>%s"
          "</CharacteristicStatusEnum></Status><CharacteristicItemId>%zu</CharacteristicItemId>"
          "<Value",
          one->kind, id, characteristic_status(verdict), item_id(q, i));
  if (isfinite(u)) {
    fputs(" combinedUncertainty=\"", q->out);
    put_number(q->out, u);
    fputs("\"", q->out);
  }
  fputs(">", q->out);
  put_number(q->out, value);
  fprintf(q->out, "</Value></%sCharacteristicMeasurement>\n", one->kind);
}

/* Of the manifest's column `date`, else of the scan's file; the standard wants a time in UTC. */
static void put_start(const qif *q, const fg_lot_foil *foil) {
  const fg_lot *lot = q->analysis->lot;
  size_t column = fg_manifest_column(&lot->manifest, FG_LOT_DATE_COLUMN);
  double days =
      fg_date_days(column == FG_NO_COLUMN ? lot->records[foil->item].date
                                          : fg_manifest_cell(&lot->manifest, foil->item, column));
  char date[FG_DATE_TEXT];
  if (!isfinite(days)) return;
  fg_date_format(days, date);
  fprintf(q->out,
          "<InspectionTraceability><InspectionStart>%s%s</InspectionStart></InspectionTraceability>"
          "\n",
          date, strchr(date, 'T') ? ":00Z" : "T00:00:00Z");
}

static void put_foil(const qif *q, size_t index) {
  const fg_lot_foil *foil = &q->analysis->foils[index];
  size_t id = results_id(q, index), known = 0;
  double u;
  for (size_t i = 0; i < q->count; i++)
    known += isfinite(fg_characteristic_value(&q->list[i], foil->foil, &u)) != 0;
  fprintf(q->out, "<MeasurementResults id=\"%zu\">\n", id);
  put_start(q, foil);
  if (known) {
    fprintf(q->out, "<MeasuredCharacteristics><CharacteristicMeasurements n=\"%zu\">\n", known);
    for (size_t i = 0; i < q->count; i++) {
      double value = fg_characteristic_value(&q->list[i], foil->foil, &u);
      if (isfinite(value)) put_measurement(q, id + 1 + i, i, value, u);
    }
    fputs("</CharacteristicMeasurements></MeasuredCharacteristics>\n", q->out);
  }
  fprintf(q->out,
          "<InspectionStatus><InspectionStatusEnum>%s</InspectionStatusEnum></InspectionStatus>"
          "<ActualComponentIds n=\"1\"><Id>%zu</Id></ActualComponentIds>\n</MeasurementResults>\n",
          inspection_status(foil->verdict), component_id(q, index));
}

/* What the manifest's columns say beside the scan, where they say something. */
static void put_attributes(const qif *q, size_t item) {
  const fg_manifest *manifest = &q->analysis->lot->manifest;
  size_t count = 0;
  for (size_t i = 1; i < manifest->columns; i++)
    count += *fg_manifest_cell(manifest, item, i) != 0;
  if (!count) return;
  fprintf(q->out, "<Attributes n=\"%zu\">", count);
  for (size_t i = 1; i < manifest->columns; i++) {
    if (!*fg_manifest_cell(manifest, item, i)) continue;
    fputs("<AttributeStr name=\"", q->out);
    fg_html_text(q->out, manifest->name[i]);
    fputs("\" value=\"", q->out);
    fg_html_text(q->out, fg_manifest_cell(manifest, item, i));
    fputs("\"/>", q->out);
  }
  fputs("</Attributes>", q->out);
}

static void put_component(const qif *q, size_t index) {
  const fg_lot_foil *foil = &q->analysis->foils[index];
  fprintf(q->out, "<ActualComponent id=\"%zu\">", component_id(q, index));
  put_attributes(q, foil->item);
  fputs("<SerialNumber>", q->out);
  fg_html_text(q->out, fg_manifest_label(&q->analysis->lot->manifest, foil->item));
  if (q->analysis->lot->records[foil->item].foil_count > 1)
    fprintf(q->out, " #%d", foil->foil->number);
  fprintf(q->out,
          "</SerialNumber><Status><InspectionStatusEnum>%s</InspectionStatusEnum></Status>"
          "</ActualComponent>\n",
          inspection_status(foil->verdict));
}

static void put_results(const qif *q) {
  size_t foils = q->analysis->foil_count;
  if (!foils) return;
  fprintf(q->out, "<Results>\n<MeasurementResultsSet n=\"%zu\">\n", foils);
  for (size_t i = 0; i < foils; i++)
    put_foil(q, i);
  fprintf(q->out,
          "</MeasurementResultsSet>\n<ActualComponentSets n=\"1\"><ActualComponentSet n=\"%zu\">\n",
          foils);
  for (size_t i = 0; i < foils; i++)
    put_component(q, i);
  fputs("</ActualComponentSet></ActualComponentSets>\n</Results>\n", q->out);
}

fg_status fg_lot_write_qif(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  qif q = {.out = out, .analysis = analysis};
  FG_TRY(fg_characteristics_list(ctx, analysis, &q.list, &q.count));
  put_head(&q);
  if (q.count) put_characteristics(&q);
  if (q.count) put_results(&q);
  fputs("</QIFDocument>\n", out);
  free(q.list);
  return fg_stream_finish(ctx, out, "results.qif");
}
