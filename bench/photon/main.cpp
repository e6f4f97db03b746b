// The photon engine, for docs/acquisition.md and docs/limits.md.
#include "bench/common/studies.h"
#include "bench/photon/study.h"

int main(int argc, char** argv) {
  using namespace parian;
  using namespace parian::photon;
  const auto on_limits = [](void (*study)(const Page&)) {
    return [study](Page page) {
      page.name = "limits";
      study(page);
    };
  };
  return run_studies(argc, argv, "acquisition",
                     {{"speed", study_speed},
                      {"totals", study_totals},
                      {"time", study_time},
                      {"similarity", study_similarity},
                      {"importance", study_importance},
                      {"dipole", study_dipole},
                      {"pictures", study_pictures},
                      {"limits", on_limits(study_limits)},
                      {"thickness", on_limits(study_thickness)},
                      {"curvature", on_limits(study_curvature)}});
}
