// parian simulate --engine photon: runs, stores and takes up photon simulations.
#pragma once

#include <string>

#include "acquire/photon_simulation.h"
#include "app/cli/command.h"

namespace parian {

struct PhotonRun {
  std::string output;
  int deflate = 0;
  double checkpoint_s = 20;
  PhotonParams params;
};

// Writes the table. Until it is there, OUTPUT.partial holds what has been gathered, at most
// checkpoint_s old; an earlier one of the same sample and parameters is taken up.
void simulate_photons(const Sample& sample, const PhotonRun& run, const Context& context);

}  // namespace parian
