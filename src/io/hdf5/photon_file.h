// What a photon simulation has gathered so far, in HDF5, so that a killed run can be taken up again
// (docs/formats.md).
#pragma once

#include <cstdint>
#include <string>

#include "acquire/photon_simulation.h"

namespace parian {

// Of another run than the given simulation's (fingerprint): Error. Sizes are checked against the
// simulation before anything is allocated. Errors name the file, and the attribute or dataset.
PhotonProgress load_photon_progress(const std::string& path, const PhotonSimulation& simulation);
void save_photon_progress(const std::string& path, const PhotonSimulation& simulation);

}  // namespace parian
