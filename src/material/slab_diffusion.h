// Diffusion in a stack of slabs with one refractive index: the fluence and its flux are continuous
// from layer to layer, and phi vanishes at the extrapolated outer boundaries. For one slab this is
// the sum of all multipoles (Donner and Jensen 2005), here in closed form per spatial frequency.
#pragma once

#include <vector>

#include "material/diffusion.h"

namespace parian {

struct SlabLayer {
  DiffusionMedium medium;
  double thickness_mm = 0;  // 0: without end, only as the last
};

struct SlabStack {
  std::vector<SlabLayer> layers;  // from the lit side
  std::size_t source_layer = 0;
  double source_in_layer_mm = 0;  // depth of the source below that layer's top
};
// Channel c; the source lies one transport mean free path deep. Throws as make_reflectance_curve.
SlabStack make_slab_stack(const Dipole& material, std::size_t channel);

// 2 pi int R J_0(q r) r dr for q in 1/mm; q = 0 is the total.
struct SlabSpectrum {
  double reflectance = 0;
  double transmittance = 0;
};
SlabSpectrum eval_spectrum(const SlabStack& stack, double q);

// The curve of either, by the inverse transform R(r) = 1/(2 pi) int R^(q) J_0(q r) q dq.
TabulatedCurve tabulate_reflectance(const SlabStack& stack);
TabulatedCurve tabulate_transmittance(const SlabStack& stack);
double eval_tabulated(const TabulatedCurve& curve, double r_mm);

}  // namespace parian
