// Colours, sizes and font of the window.
#pragma once

namespace parian {

// `scale`: of the display, 1 for about 96 dpi. Needs ImGui's context.
void set_theme(float scale);

}  // namespace parian
