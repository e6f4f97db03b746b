// Where the window's panels are: fixed bars, and columns whose borders are dragged. No drawing.
#pragma once

namespace parian {

struct PanelBox {
  float x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const PanelBox&, const PanelBox&) = default;
};

// Parts of the room: kept when the window changes its size.
struct LayoutShares {
  float map = 0.26f;   // width of the map's column
  float side = 0.25f;  // width of the tabs' column
  float flat = 0.50f;  // height of the flat view over the profile
  float tabs = 0.64f;  // height of the upper tabs over the lower ones
  friend bool operator==(const LayoutShares&, const LayoutShares&) = default;
};

struct Layout {
  PanelBox menu, tools, view, flat, profile, tabs, info, status;
  // Borders that are dragged: view | map, map | tabs, flat / profile, tabs / info.
  PanelBox split_map, split_side, split_flat, split_tabs;
};

// Pixels of the window; `em` is the font's height, `bar` that of a line with a frame. Every panel
// is at least a pixel wide and high and lies inside any window of at least that size.
Layout make_layout(float width, float height, float em, float bar, const LayoutShares& shares);

enum class Split { map, side, flat, tabs };
// The shares after a border was dragged by a number of pixels; panels keep a least size.
LayoutShares drag_split(const LayoutShares& shares, Split split, float pixels, float width,
                        float height, float em, float bar);

}  // namespace parian
