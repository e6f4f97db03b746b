#include "app/studio/layout.h"

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

constexpr float tools_em = 5.6f, split_em = 0.35f;
constexpr float least_column_em = 13, least_row_em = 8;

float at_least_one(float size) {
  return std::max(1.0f, std::floor(size));
}

// What is left for the columns, and for the rows between the bars.
float columns_room(float width, float em) {
  return at_least_one(width - tools_em * em - 2 * split_em * em);
}
float rows_room(float height, float em, float bar) {
  return at_least_one(height - 2 * bar - split_em * em);
}

// A share that leaves `least` to both sides where there is room for that.
float keep_share(float share, float room, float least, float others) {
  const float low = std::min(least / room, 0.3f);
  return std::clamp(share, low, std::max(low, 1 - others - low));
}

// Two panels over each other with a border between them.
struct Rows {
  PanelBox upper, split, lower;
};
Rows make_rows(const PanelBox& column, float share, float split) {
  const float upper = at_least_one(share * (column.height - split));
  return {{column.x, column.y, column.width, upper},
          {column.x, column.y + upper, column.width, split},
          {column.x, column.y + upper + split, column.width,
           at_least_one(column.height - upper - split)}};
}

}  // namespace

Layout make_layout(float width, float height, float em, float bar, const LayoutShares& shares) {
  width = at_least_one(width);
  height = at_least_one(height);
  // A window too small for its bars shrinks them.
  bar = std::min(bar, height / 3);
  em = std::min(em, width / (3 * tools_em));
  const float tools = at_least_one(tools_em * em), split = at_least_one(split_em * em);
  const float columns = columns_room(width, em), rows = at_least_one(height - 2 * bar);
  const float least = least_column_em * em, least_row = least_row_em * em;
  const float map = keep_share(shares.map, columns, least, shares.side);
  const float side = keep_share(shares.side, columns, least, map);
  const float map_width = at_least_one(map * columns), side_width = at_least_one(side * columns);
  const float view_width = at_least_one(columns - map_width - side_width);
  Layout layout;
  layout.menu = {0, 0, width, at_least_one(bar)};
  layout.tools = {0, bar, tools, rows};
  layout.view = {tools, bar, view_width, rows};
  layout.split_map = {tools + view_width, bar, split, rows};
  const float map_x = layout.split_map.x + split;
  layout.split_side = {map_x + map_width, bar, split, rows};
  const float side_x = layout.split_side.x + split;
  const float row_room = rows_room(height, em, bar);
  const Rows left = make_rows({map_x, bar, map_width, rows},
                              keep_share(shares.flat, row_room, least_row, 0), split);
  const Rows right = make_rows({side_x, bar, at_least_one(width - side_x), rows},
                               keep_share(shares.tabs, row_room, least_row, 0), split);
  layout.flat = left.upper;
  layout.split_flat = left.split;
  layout.profile = left.lower;
  layout.tabs = right.upper;
  layout.split_tabs = right.split;
  layout.info = right.lower;
  layout.status = {0, bar + rows, width, at_least_one(height - bar - rows)};
  return layout;
}

LayoutShares drag_split(const LayoutShares& shares, Split split, float pixels, float width,
                        float height, float em, float bar) {
  LayoutShares moved = shares;
  const float columns = columns_room(width, em), rows = rows_room(height, em, bar);
  const float least = least_column_em * em;
  switch (split) {
    case Split::map:
      moved.map = keep_share(shares.map - pixels / columns, columns, least, shares.side);
      break;
    case Split::side: {
      // What the tabs lose the map gets: the view stays.
      const float both = shares.map + shares.side;
      moved.side = std::clamp(shares.side - pixels / columns, std::min(least / columns, both / 2),
                              std::max(both / 2, both - least / columns));
      moved.map = both - moved.side;
      break;
    }
    case Split::flat:
      moved.flat = keep_share(shares.flat + pixels / rows, rows, least_row_em * em, 0);
      break;
    case Split::tabs:
      moved.tabs = keep_share(shares.tabs + pixels / rows, rows, least_row_em * em, 0);
      break;
  }
  return moved;
}

}  // namespace parian
