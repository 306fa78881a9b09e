/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/mark_nodes.h"

#include <math.h>

static fg_mark_node node_of_dot(const fg_mark *mark, fg_point along, size_t i, size_t count) {
  double angle = 2 * M_PI * ((double)i + 0.5) / (double)count, x = cos(angle), y = sin(angle);
  double weight = 2 * (x * along.x + y * along.y) / (double)count;
  return (fg_mark_node){{mark->at_mm.x + mark->reach_mm * x, mark->at_mm.y + mark->reach_mm * y},
                        {weight * x, weight * y}};
}

static fg_mark_node node_of_corner(const fg_mark *mark, fg_point along, size_t i, size_t count) {
  double off = mark->reach_mm * ((2 * (double)i + 1) / (double)count - 1);
  return (fg_mark_node){{mark->at_mm.x - off * along.y, mark->at_mm.y + off * along.x},
                        {along.x / (double)count, along.y / (double)count}};
}

size_t fg_mark_nodes(const fg_mark *mark, fg_point along, size_t count,
                     fg_mark_node nodes[FG_MARK_NODES_MAX]) {
  bool corner = mark->polarity != 0;
  if (!(mark->reach_mm > 0) || count < 2) {
    nodes[0] = (fg_mark_node){mark->at_mm, along};
    return 1;
  }
  for (size_t i = 0; i < count; i++)
    nodes[i] = corner ? node_of_corner(mark, along, i, count) : node_of_dot(mark, along, i, count);
  return count;
}
