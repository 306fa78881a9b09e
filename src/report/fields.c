#include <math.h>
#include <string.h>

#include "report/words.h"

/* One row: a quantity with an uncertainty beside it, one without, a pair, a count. */
#define NUMBER(type, name, member, u_member, unit, symbol, decimals, words)                        \
  {                                                                                                \
    name, unit, symbol, words, FG_FIELD_NUMBER, offsetof(type, member), offsetof(type, u_member),  \
        decimals                                                                                   \
  }
#define BARE(type, name, member, unit, symbol, decimals, words)                                    \
  {                                                                                                \
    name, unit, symbol, words, FG_FIELD_NUMBER, offsetof(type, member), FG_NO_UNCERTAINTY,         \
        decimals                                                                                   \
  }
#define PAIR(type, name, member, u_member, unit, symbol, decimals, words)                          \
  {                                                                                                \
    name, unit, symbol, words, FG_FIELD_PAIR, offsetof(type, member), offsetof(type, u_member),    \
        decimals                                                                                   \
  }
#define COUNT(type, name, member, words)                                                           \
  { name, "", "n", words, FG_FIELD_COUNT, offsetof(type, member), FG_NO_UNCERTAINTY, 0 }

static const fg_report_field foil_fields[] = {
    BARE(fg_foil, "rotation_deg", rotation_deg, "°", "rotation", 2,
         "direction of the foil's middle seen from the overall centre"),
    NUMBER(fg_foil, "thickness_mm", thickness_mm, u_thickness_mm, "mm", "t", 4, "strip thickness"),
    NUMBER(fg_foil, "overall.radius_mm", overall.radius_mm, overall.u_radius_mm, "mm", "R0", 4,
           "overall radius"),
    PAIR(fg_foil, "overall.centre_mm", overall.centre_mm, overall.u_centre_mm, "mm", "O", 4,
         "overall centre in the scan"),
    NUMBER(fg_foil, "overall.springback_error_pct", overall.springback_error_pct,
           overall.u_springback_error_pct, "%", "springback", 3,
           "springback error of the overall radius"),
    BARE(fg_foil, "overall.rms_um", overall.rms_um, "µm", "rms", 2,
         "residual of the lands from the overall circle"),
    COUNT(fg_foil, "overall.points", overall.points, "points on the lands"),
    BARE(fg_foil, "noise_um", noise_um, "µm", "noise", 3,
         "standard deviation of the midline's residuals"),
    BARE(fg_foil, "correlation_mm", correlation_mm, "mm", "correlation", 3,
         "correlation length of the residuals along the strip"),
    BARE(fg_foil, "edge_model_um", edge_model_um, "µm", "edge model", 3,
         "systematic part of the edges' uncertainty"),
    NUMBER(fg_foil, "correction.overall_radius_mm", correction.overall_radius_mm,
           correction.u_overall_radius_mm, "mm", "ΔR0", 4,
           "what the scanner's model moved the overall radius by"),
    NUMBER(fg_foil, "correction.radius_mm", correction.radius_mm, correction.u_radius_mm, "mm",
           "ΔR", 4, "what the scanner's model moved a bump radius by, at most"),
    NUMBER(fg_foil, "correction.height_mm", correction.height_mm, correction.u_height_mm, "mm",
           "Δh", 4, "what the scanner's model moved a bump height by, at most"),
};

static const fg_report_field bump_fields[] = {
    NUMBER(fg_bump, "radius_mm", radius_mm, u_radius_mm, "mm", "R", 4, "bump radius"),
    PAIR(fg_bump, "centre_mm", centre_mm, u_centre_mm, "mm", "C", 4, "bump centre in the scan"),
    NUMBER(fg_bump, "centre_to_centre_mm", centre_to_centre_mm, u_centre_to_centre_mm, "mm", "X", 4,
           "bump centre to overall centre"),
    NUMBER(fg_bump, "bump_angle_deg", bump_angle_deg, u_bump_angle_deg, "°", "α", 2, "bump angle"),
    NUMBER(fg_bump, "intersection_angle_deg", intersection_angle_deg, u_intersection_angle_deg, "°",
           "θ", 2, "intersection angle"),
    NUMBER(fg_bump, "height_mm", height_mm, u_height_mm, "mm", "h", 4, "bump height, foil free"),
    NUMBER(fg_bump, "clearance_mm", clearance_mm, u_clearance_mm, "mm", "C_loc", 4,
           "local clearance, foil free"),
    NUMBER(fg_bump, "clearance_error", clearance_error, u_clearance_error, "", "e_C", 3,
           "clearance error, a ratio, foil free"),
    NUMBER(fg_bump, "height_fitted_mm", height_fitted_mm, u_height_fitted_mm, "mm", "h_fit", 4,
           "bump height, foil fitted into the sleeve"),
    NUMBER(fg_bump, "clearance_fitted_mm", clearance_fitted_mm, u_clearance_fitted_mm, "mm",
           "C_fit", 4, "local clearance, foil fitted into the sleeve"),
    NUMBER(fg_bump, "radius_error_pct", radius_error_pct, u_radius_error_pct, "%", "e_R", 2,
           "springback error of the bump radius"),
    NUMBER(fg_bump, "bump_angle_error_pct", bump_angle_error_pct, u_bump_angle_error_pct, "%",
           "e_α", 2, "springback error of the bump angle"),
    NUMBER(fg_bump, "height_model_mm", height_model_mm, u_height_model_mm, "mm", "h_m", 4,
           "bump height that the springback model predicts from the radius"),
    NUMBER(fg_bump, "bump_angle_model_deg", bump_angle_model_deg, u_bump_angle_model_deg, "°",
           "α_m", 2, "bump angle that the springback model predicts from the radius"),
    BARE(fg_bump, "rms_um", rms_um, "µm", "rms", 2, "residual from the bump circle"),
    COUNT(fg_bump, "points", points, "points in the fit"),
    BARE(fg_bump, "arc_start_mm", arc_start_mm, "mm", "from", 3, "where the fitted arc starts"),
    BARE(fg_bump, "arc_end_mm", arc_end_mm, "mm", "to", 3, "where the fitted arc ends"),
    BARE(fg_bump, "position_deg", position_deg, "°", "position", 2,
         "direction of the bump seen from the overall centre"),
};

static const fg_report_field disc_fields[] = {
    NUMBER(fg_disc, "radius_mm", radius_mm, u_radius_mm, "mm", "r", 4, "radius"),
    NUMBER(fg_disc, "diameter_mm", diameter_mm, u_diameter_mm, "mm", "d", 4, "diameter"),
    PAIR(fg_disc, "centre_mm", centre_mm, u_centre_mm, "mm", "centre", 4, "centre in the scan"),
    NUMBER(fg_disc, "roundness_um", roundness_um, u_roundness_um, "µm", "RONt", 1,
           "roundness deviation"),
    BARE(fg_disc, "rms_um", rms_um, "µm", "rms", 2, "residual from the circle"),
    BARE(fg_disc, "coverage_deg", coverage_deg, "°", "coverage", 0,
         "how much of the circumference was usable"),
    BARE(fg_disc, "blur_um", blur_um, "µm", "blur", 1, "blur of the edge, standard deviation"),
    NUMBER(fg_disc, "radius_correction_mm", radius_correction_mm, u_radius_correction_mm, "mm",
           "Δr", 4, "what the scanner's model moved the radius by"),
    COUNT(fg_disc, "points", points, "points in the fit"),
};

#define ROWS(table) (sizeof(table) / sizeof(table)[0])

const fg_report_field *fg_report_fields(fg_report_owner owner, size_t *count) {
  switch (owner) {
  case FG_REPORT_FOIL:
    *count = ROWS(foil_fields);
    return foil_fields;
  case FG_REPORT_BUMP:
    *count = ROWS(bump_fields);
    return bump_fields;
  case FG_REPORT_DISC:
    *count = ROWS(disc_fields);
    return disc_fields;
  }
  *count = 0;
  return NULL;
}

const fg_report_field *fg_report_find(fg_report_owner owner, const char *name) {
  size_t count;
  const fg_report_field *fields = fg_report_fields(owner, &count);
  for (size_t i = 0; i < count; i++)
    if (!strcmp(fields[i].name, name)) return &fields[i];
  return NULL;
}

static double read_double(const void *object, size_t offset) {
  double value;
  memcpy(&value, (const char *)object + offset, sizeof value);
  return value;
}

double fg_report_value(const fg_report_field *field, const void *object) {
  size_t count;
  switch (field->kind) {
  case FG_FIELD_NUMBER:
    return read_double(object, field->offset);
  case FG_FIELD_COUNT:
    memcpy(&count, (const char *)object + field->offset, sizeof count);
    return (double)count;
  case FG_FIELD_PAIR:
    break;
  }
  return NAN;
}

double fg_report_uncertainty(const fg_report_field *field, const void *object) {
  if (field->kind != FG_FIELD_NUMBER || field->u_offset == FG_NO_UNCERTAINTY) return NAN;
  return read_double(object, field->u_offset);
}

void fg_report_pair(const fg_report_field *field, const void *object, double value[2],
                    double u[2]) {
  memcpy(value, (const char *)object + field->offset, 2 * sizeof *value);
  memcpy(u, (const char *)object + field->u_offset, 2 * sizeof *u);
}
