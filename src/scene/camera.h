// Primary rays of the pinhole camera, the view that frames a mesh, and what is wrong with a view.
#pragma once

#include <string>

#include "scene/scene.h"

namespace parian {

struct CameraRay {
  Vec3 origin;
  Vec3 direction;  // unit
};

// Axes of the picture, unit and orthogonal, and half its extent at distance 1.
struct CameraFrame {
  Vec3 position;
  Vec3 right;
  Vec3 up;
  Vec3 forward;
  double half_width = 1;
  double half_height = 1;
  int width = 1;
  int height = 1;
};
// An `up` along the view is replaced by another axis.
CameraFrame make_camera_frame(const Camera& camera);

// Through (px, py): pixel (x, y) covers [x, x + 1) x [y, y + 1), row 0 on top.
CameraRay make_camera_ray(const CameraFrame& frame, double px, double py);
CameraRay make_camera_ray(const Camera& camera, double px, double py);

// Moves the camera so that the box fills the picture, with a margin of 5 %: 20 degrees to the
// right of the +z axis, 15 degrees above the target. The target stays; fov and size are kept.
void frame_box(Camera& camera, const Bounds3& box);

enum class ViewProblem { none, inside_box, box_outside_view };
// Inside: in the closed box. Outside: the whole box is behind the camera or beyond one side of the
// picture.
ViewProblem check_view(const Camera& camera, const Bounds3& box);

}  // namespace parian
