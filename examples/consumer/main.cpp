// Makes a table of a homogeneous material in memory, fits profiles to it, evaluates one against the
// dipole that the table came from, and writes the map to the file named on the command line.
#include <parian/base/error.h>
#include <parian/fit/fit.h>
#include <parian/io/hdf5/map_file.h>
#include <parian/material/bssrdf_table.h>
#include <parian/material/material.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) {
  try {
    const parian::Material marble = parian::Dipole{{{0.02, 2.0}}, 1.5};
    parian::TableHeader header;
    header.width = 24;
    header.height = 20;
    header.channels = 1;
    header.pixel_pitch_mm = 0.5;
    header.eta = 1.5;
    header.offsets = parian::half_disc_offsets(6);
    const parian::BssrdfTable table = parian::read_table(*parian::make_slices(marble, header));

    parian::FitParams params;
    params.segments = 6;
    params.lambda = 0.001;
    const parian::FitResult result = parian::fit_profiles(*parian::make_slices(table), params);
    const parian::Profile profile = parian::get_profile(result.map, 0, 12, 10);
    const double r = 1.5, expected = parian::eval_dipole({0.02, 2.0}, 1.5, r);
    const double found = std::exp(parian::eval_log_profile(profile, r));
    std::printf("R_d(%.1f mm): dipole %.6f, fitted %.6f per mm^2\n", r, expected, found);
    if (argc > 1) parian::save_profile_map(argv[1], result.map);
    return std::abs(found / expected - 1) < 0.02 ? 0 : 1;
  } catch (const parian::Error& error) {
    std::fprintf(stderr, "consumer: %s\n", error.what());
    return 1;
  }
}
