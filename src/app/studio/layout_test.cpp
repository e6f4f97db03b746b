#include "app/studio/layout.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace parian {
namespace {

std::vector<PanelBox> panels(const Layout& layout) {
  return {layout.menu, layout.tools,      layout.view,    layout.split_map,
          layout.flat, layout.split_flat, layout.profile, layout.split_side,
          layout.tabs, layout.split_tabs, layout.info,    layout.status};
}

bool overlaps(const PanelBox& a, const PanelBox& b) {
  constexpr float slack = 0.01f;
  return a.x + a.width > b.x + slack && b.x + b.width > a.x + slack &&
         a.y + a.height > b.y + slack && b.y + b.height > a.y + slack;
}

TEST(Layout, FillsTheWindowWithoutOverlap) {
  for (const auto& [width, height, em] :
       {std::array{1440.0f, 900.0f, 14.0f}, std::array{1280.0f, 720.0f, 14.0f},
        std::array{3840.0f, 2160.0f, 28.0f}, std::array{700.0f, 400.0f, 14.0f}}) {
    const Layout layout = make_layout(width, height, em, 1.4f * em, {});
    const auto boxes = panels(layout);
    float area = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      area += boxes[i].width * boxes[i].height;
      EXPECT_LE(boxes[i].x + boxes[i].width, width + 0.01f) << i;
      EXPECT_LE(boxes[i].y + boxes[i].height, height + 0.01f) << i;
      for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(overlaps(boxes[i], boxes[k])) << i << k;
    }
    EXPECT_NEAR(area / (width * height), 1, 0.01) << width;
  }
}

TEST(Layout, AnyWindowHasPanelsOfAPixel) {
  for (const float width : {0.0f, 1.0f, 7.0f, 40.0f, 200.0f})
    for (const float height : {0.0f, 1.0f, 30.0f, 100.0f})
      for (const PanelBox& box : panels(make_layout(width, height, 14, 20, {0.9f, 0.9f, 2, -1}))) {
        EXPECT_GE(box.width, 1);
        EXPECT_GE(box.height, 1);
      }
}

TEST(Layout, BordersFollowTheMouseUpToALeastSize) {
  const LayoutShares shares;
  const auto lay = [](const LayoutShares& s) { return make_layout(1440, 900, 14, 20, s); };
  const Layout before = lay(shares);
  const Layout wider = lay(drag_split(shares, Split::map, -100, 1440, 900, 14, 20));
  EXPECT_NEAR(wider.split_map.x, before.split_map.x - 100, 1.5);
  EXPECT_NEAR(wider.split_side.x, before.split_side.x, 1.5);
  const Layout side = lay(drag_split(shares, Split::side, 40, 1440, 900, 14, 20));
  EXPECT_NEAR(side.split_side.x, before.split_side.x + 40, 1.5);
  EXPECT_NEAR(side.split_map.x, before.split_map.x, 1.5);
  const Layout lower = lay(drag_split(shares, Split::flat, 60, 1440, 900, 14, 20));
  EXPECT_NEAR(lower.split_flat.y, before.split_flat.y + 60, 1.5);
  const Layout tabs = lay(drag_split(shares, Split::tabs, -30, 1440, 900, 14, 20));
  EXPECT_NEAR(tabs.split_tabs.y, before.split_tabs.y - 30, 1.5);
  for (const Split split : {Split::map, Split::side, Split::flat, Split::tabs})
    for (const float pixels : {-5000.0f, 5000.0f})
      for (const PanelBox& box :
           panels(lay(drag_split(shares, split, pixels, 1440, 900, 14, 20)))) {
        EXPECT_GE(box.width, 4);
        EXPECT_GE(box.height, 4);
      }
}

}  // namespace
}  // namespace parian
