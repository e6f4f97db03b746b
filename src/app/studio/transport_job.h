// Precomputed transport of the stage for homogeneous materials (Xu et al. 2007): made in the
// background while nothing moves, after which an edit of the coefficients is one pass over the
// vertices. When a light turns or is added only that light is computed anew; other colours and
// strengths are factors. Not under layers.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "app/studio/stage.h"
#include "base/progress.h"
#include "transport/homogeneous_transport.h"
#include "transport/precompute.h"

namespace parian {

// What transport depends on.
struct TransportKey {
  std::shared_ptr<const Stage> stage;
  Lighting lighting;  // those that are on
  double eta = 1.3;
};

struct ReadyTransport {
  TransportKey key;
  std::shared_ptr<const HomogeneousTransport> transport;
};

// Factors of the colours that make the transport's lights those of `wanted`, one for each light;
// none where the transport is of another stage, eta or place of a light.
std::optional<std::vector<Rgb>> find_light_scales(const ReadyTransport& ready,
                                                  const TransportKey& wanted);

// For an editor: samples by the number of vertices, half the directions, so that it is ready soon.
// `parian precompute` takes more.
PrecomputeParams choose_transport_params(const Stage& stage);

// `earlier` may be null; its lights that are the same are kept. Of the same parameters.
std::shared_ptr<const ReadyTransport> make_ready_transport(const TransportKey& key,
                                                           const PrecomputeParams& params,
                                                           const ReadyTransport* earlier,
                                                           const Progress& progress);

struct Studio;
TransportKey make_transport_key(const Studio& studio);
// A homogeneous material without layers, and the user has not switched it off.
bool can_use_transport(const Studio& studio);
// Starts and stops the job as the present state needs it; once a frame.
void update_transport(Studio& studio);

}  // namespace parian
