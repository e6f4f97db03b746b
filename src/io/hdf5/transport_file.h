// Precomputed transport of homogeneous materials in HDF5 (docs/formats.md).
#pragma once

#include <string>

#include "transport/homogeneous_transport.h"
#include "transport/precompute.h"

namespace parian {

struct TransportFile {
  HomogeneousTransport transport;
  TransportFingerprint fingerprint;  // of all lights, also of those that are still to be made
  std::string provenance;

  bool is_complete() const { return transport.lights.size() == fingerprint.lights.size(); }
};

// Errors name the file, and the attribute or dataset at fault.
TransportFile load_transport(const std::string& path);
void save_transport(const std::string& path, const TransportFile& file);

// Throws Error naming what differs: the mesh, a light, or the parameters (with `params`).
void check_fingerprint(const TransportFile& file, const std::string& path,
                       const TransportFingerprint& expected, bool with_parameters);

}  // namespace parian
