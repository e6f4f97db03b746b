// A coefficient of a homogeneous material over a range, for render --sweep.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"
#include "material/dipole.h"

namespace parian {

struct Sweep {
  std::string name;  // sigma_a, sigma_s, sigma_s_prime, g or eta
  std::vector<double> values;
};
// "sigma_s=0.3:4:30": first, last and number of values. Throws Error(usage).
Sweep parse_sweep(const std::string& text);

// All channels get the value; sigma_s and g keep each other, sigma_s' follows.
Dipole set_coefficient(Dipole material, const std::string& name, double value);

// "frame-##.png", 7 of 30 -> "frame-07.png"; without '#' the name itself.
std::string frame_name(const std::string& pattern, std::size_t frame);

// Pictures of one size side by side, row by row, at least three to a row.
Image make_contact_sheet(const std::vector<Image>& pictures);

}  // namespace parian
