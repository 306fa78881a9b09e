/* Curves in the report of the loop on scans. */
#ifndef FG_REPORT_SCAN_LOOP_SCAN_LOOP_SHAPES_H
#define FG_REPORT_SCAN_LOOP_SCAN_LOOP_SHAPES_H

#include "core/json_writer.h"
#include "scan_loop/state.h"

/* The member `shape`: pairs of coordinate and deviation in um. scan.x, scan.y in mm, where edges
 * were measured; foil.s from -1 at the lip's end to 1 at the free end, outwards from O; bump.phi
 * from -1 to 1 between the fillets, away from the arc's centre, beside the bump's circle;
 * edge.normal in degrees. */
fg_status fg_json_scan_shape(fg_context *ctx, fg_json *json, const fg_scan_loop *loop,
                             const fg_effect_found *effect);

#endif
