#include "material/diffusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/test_errors.h"
#include "material/material.h"
#include "material/slab_diffusion.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

// 2 pi int R r dr with r = e^t: the trapezoid rule converges geometrically.
double integrate(const ReflectanceCurve& curve, double unit) {
  constexpr double step = 0.02;
  double sum = 0;
  for (double t = -16; t < 16; t += step) {
    const double r = unit * std::exp(t);
    sum += eval_curve(curve, r) * r * r * step;
  }
  return 2 * pi * sum;
}

Dipole make_material(DipoleCoefficients medium, DiffusionModel model, double eta = 1.5,
                     double thickness_mm = 0) {
  return {.channels = {medium}, .eta = eta, .model = model, .thickness_mm = thickness_mm};
}

TEST(Fresnel, MomentsGiveTheExactBoundaryFactors) {
  const auto factor = [](double eta) {
    const FresnelMoments moments = fresnel_moments(eta);
    return (1 + 3 * moments.second) / (1 - 2 * moments.first);
  };
  EXPECT_NEAR(factor(1.3), 2.341, 5e-4);
  EXPECT_NEAR(factor(1.4), 2.949, 6e-4);
  EXPECT_NEAR(factor(1.5), 3.628, 5e-4);
  EXPECT_EQ(factor(1), 1);
  EXPECT_NEAR(factor(1 + 1e-7), 1, 1e-5);
  EXPECT_NEAR(factor(1 - 1e-7), 1, 1e-5);
}

// Light in from a thinner medium and out of it is the same: n^2 (1 - 2 C_1(n)) = 1 - 2 C_1(1 / n).
TEST(Fresnel, MomentsObeyReciprocity) {
  for (const double eta : {1.1, 1.33, 1.5, 2.4})
    EXPECT_NEAR(eta * eta * (1 - 2 * fresnel_moments(eta).first),
                1 - 2 * fresnel_moments(1 / eta).first, 1e-7)
        << eta;
}

TEST(Diffusion, TotalsMatchQuadrature) {
  Rng rng = make_rng(5);
  for (int i = 0; i < 60; ++i) {
    const DipoleCoefficients medium{.sigma_a = std::pow(10.0, -3 + 3 * sample_uniform(rng)),
                                    .sigma_s_prime = std::pow(10.0, -1 + 2 * sample_uniform(rng))};
    const double eta = 1 + 0.6 * sample_uniform(rng);
    for (const auto model :
         {DiffusionModel::classic, DiffusionModel::better, DiffusionModel::normalized}) {
      const ReflectanceCurve curve = make_reflectance_curve(make_material(medium, model, eta), 0);
      const double total = total_of(curve);
      // The step at the centre of normalised diffusion costs the trapezoid rule some digits.
      const double tolerance = model == DiffusionModel::normalized ? 1e-4 : 1e-6;
      EXPECT_NEAR(integrate(curve, 1 / (medium.sigma_a + medium.sigma_s_prime)), total,
                  tolerance * total);
    }
  }
}

TEST(Diffusion, ClassicIsTheDipole) {
  const DipoleCoefficients medium{0.03, 1.7};
  const auto curve = make_reflectance_curve(make_material(medium, DiffusionModel::classic, 1.3), 0);
  for (const double r : {0.0, 0.1, 1.0, 5.0, 30.0})
    EXPECT_NEAR(eval_curve(curve, r) / eval_dipole(medium, 1.3, r), 1, 1e-12) << r;
  EXPECT_NEAR(total_of(curve), dipole_albedo(medium, 1.3), 1e-14);
}

TEST(Diffusion, NothingAbsorbedEverythingReturns) {
  for (const auto model :
       {DiffusionModel::classic, DiffusionModel::better, DiffusionModel::normalized})
    for (const double eta : {1.0, 1.3, 1.5})
      EXPECT_NEAR(total_of(make_reflectance_curve(make_material({0, 2}, model, eta), 0)), 1, 1e-9);
}

// Exact totals of isotropic half-spaces at eta 1 and 1.5 by the H function and the Fresnel
// equations (d'Eon's and Giovanelli's values among them), per incident flux at normal incidence
// without the specular part: divided by 1 - F(0) they are per transmitted flux.
TEST(Diffusion, TheBetterDipoleIsNearerToExactTotals) {
  struct Row {
    double albedo, matched, glass;
  };
  for (const Row row :
       {Row{0.5, .11523, .04425}, Row{0.8, .28525, .13198}, Row{0.9, .41495, .21992},
        Row{0.95, .53554, .32112}, Row{0.99, .75272, .56198}, Row{0.999, .91285, .80146}}) {
    const DipoleCoefficients medium{1 - row.albedo, row.albedo};
    const auto error = [&](DiffusionModel model, double eta, double exact) {
      return std::abs(
          total_of(make_reflectance_curve(make_material(medium, model, eta), 0)) / exact - 1);
    };
    const double glass = row.glass / (1 - 0.04);
    EXPECT_LT(error(DiffusionModel::better, 1.5, glass), 0.115) << row.albedo;
    EXPECT_LT(error(DiffusionModel::better, 1, row.matched), 0.21) << row.albedo;
    if (row.albedo < 0.95) {
      EXPECT_LT(error(DiffusionModel::better, 1.5, glass),
                error(DiffusionModel::classic, 1.5, glass))
          << row.albedo;
    }
  }
}

TEST(Diffusion, CurvesAreFiniteAndFall) {
  for (const auto model :
       {DiffusionModel::classic, DiffusionModel::better, DiffusionModel::normalized})
    for (const double thickness : {0.0, 3.0}) {
      if (model == DiffusionModel::normalized && thickness > 0) continue;
      const auto curve = make_reflectance_curve(make_material({0.05, 2}, model, 1.3, thickness), 0);
      double last = eval_curve(curve, 0);
      EXPECT_TRUE(std::isfinite(last));
      for (double r = 0.02; r < 30; r += 0.05) {
        const double value = eval_curve(curve, r);
        ASSERT_GT(value, 0) << r;
        ASSERT_LE(value, last) << r;
        last = value;
      }
    }
}

TEST(Diffusion, EditedCurvesAreTheModelTimesTheirGain) {
  Dipole material = make_material({0.03, 1.7}, DiffusionModel::better);
  const auto plain = make_reflectance_curve(material, 0);
  material.reflectance_gain = {{1, 1}, {3, 2}};
  const auto edited = make_reflectance_curve(material, 0);
  EXPECT_EQ(eval_curve(edited, 0.5), eval_curve(plain, 0.5));
  EXPECT_NEAR(eval_curve(edited, 2), 1.5 * eval_curve(plain, 2), 1e-14);
  EXPECT_EQ(eval_curve(edited, 9), 2 * eval_curve(plain, 9));
  EXPECT_NEAR(integrate(edited, 0.5), total_of(edited), 1e-4 * total_of(edited));
  EXPECT_GT(total_of(edited), total_of(plain));
  material.reflectance_gain = {{0, 3}};
  EXPECT_NEAR(total_of(make_reflectance_curve(material, 0)), 3 * total_of(plain), 1e-4);
}

// sigma in 1/mm and r in mm: R(k sigma, r / k) = k^2 R(sigma, r).
TEST(Diffusion, UnitsScale) {
  for (const auto model : {DiffusionModel::better, DiffusionModel::normalized}) {
    const double base = eval_curve(make_reflectance_curve(make_material({.02, 1.4}, model), 0), .9);
    EXPECT_NEAR(eval_curve(make_reflectance_curve(make_material({.06, 4.2}, model), 0), .3),
                9 * base, 1e-12 * base);
  }
}

// Donner and Jensen 2005, Eqs. 10 to 13: the sum over mirrored dipoles.
double sum_multipoles(const DiffusionMedium& medium, double thickness, double r, bool through) {
  double sum = 0;
  const double period = 2 * (thickness + 2 * medium.extrapolation_mm);
  for (int i = -200; i <= 200; ++i) {
    const double real = period * i + medium.mean_free_path_mm;
    const double image = period * i - medium.mean_free_path_mm - 2 * medium.extrapolation_mm;
    const auto source = [&](double z) {
      const double height = through ? thickness - z : z;
      const double d = std::hypot(r, height);
      const double decay = std::exp(-medium.sigma_tr * d);
      return medium.C_E * height * (medium.sigma_tr + 1 / d) * decay / (d * d) +
             medium.C_phi / medium.D * decay / d;
    };
    sum += source(real) - source(image);
  }
  return medium.alpha_prime * sum / (4 * pi);
}

TEST(Slab, IsTheSumOfMultipoles) {
  for (const auto model : {DiffusionModel::classic, DiffusionModel::better})
    for (const double thickness : {0.8, 2.0, 10.0}) {
      const DipoleCoefficients coefficients{0.1, 2};
      const SlabStack stack =
          make_slab_stack(make_material(coefficients, model, 1.4, thickness), 0);
      const TabulatedCurve back = tabulate_reflectance(stack), on = tabulate_transmittance(stack);
      const DiffusionMedium medium = make_diffusion_medium(coefficients, 1.4, model);
      for (const double r : {0.0, 0.05, 0.3, 1.0, 3.0, 6.0}) {
        // phi has the density's sign for both real and image sources: C_phi (real - image).
        const double expected = sum_multipoles(medium, thickness, r, false);
        EXPECT_NEAR(eval_tabulated(back, r) / expected, 1, 2e-5) << thickness << ' ' << r;
        const double through = sum_multipoles(medium, thickness, r, true);
        EXPECT_NEAR(eval_tabulated(on, r) / through, 1, 2e-5) << thickness << ' ' << r;
      }
    }
}

TEST(Slab, LosesNothingWithoutAbsorption) {
  for (const auto model : {DiffusionModel::classic, DiffusionModel::better})
    for (const double thickness : {0.6, 1.0, 40.0}) {
      const SlabSpectrum total =
          eval_spectrum(make_slab_stack(make_material({0, 2}, model, 1.4, thickness), 0), 0);
      EXPECT_NEAR(total.reflectance + total.transmittance, 1, 1e-8) << thickness;
    }
}

TEST(Slab, TotalsMatchQuadrature) {
  const SlabStack stack =
      make_slab_stack(make_material({0.05, 2}, DiffusionModel::better, 1.4, 2), 0);
  const TabulatedCurve back = tabulate_reflectance(stack), on = tabulate_transmittance(stack);
  EXPECT_NEAR(integrate({back}, 0.5), back.total, 1e-5 * back.total);
  EXPECT_NEAR(integrate({on}, 0.5), on.total, 1e-5 * on.total);
}

TEST(Slab, ThickOnesAreHalfSpaces) {
  const auto half = make_reflectance_curve(make_material({0.1, 2}, DiffusionModel::better), 0);
  const auto slab =
      make_reflectance_curve(make_material({0.1, 2}, DiffusionModel::better, 1.5, 60), 0);
  EXPECT_NEAR(total_of(slab), total_of(half), 1e-9);
  for (const double r : {0.0, 0.1, 1.0, 5.0, 10.0})
    EXPECT_NEAR(eval_curve(slab, r) / eval_curve(half, r), 1, 2e-5) << r;
}

// Cut anywhere, above or below the source, a slab stays what it is.
TEST(Slab, LayersOfOneMediumAreOneSlab) {
  const DipoleCoefficients medium{0.05, 2};
  const SlabStack whole = make_slab_stack(make_material(medium, DiffusionModel::better, 1.4, 3), 0);
  for (const double cut : {0.1, 0.4, 1.0, 2.9}) {
    Dipole material = make_material(medium, DiffusionModel::better, 1.4, cut);
    material.below = {{{medium}, 3 - cut}};
    const SlabStack stack = make_slab_stack(material, 0);
    for (const double q : {0.0, 0.1, 1.0, 4.0}) {
      const SlabSpectrum a = eval_spectrum(whole, q), b = eval_spectrum(stack, q);
      EXPECT_NEAR(a.reflectance, b.reflectance, 1e-12 * a.reflectance) << cut << ' ' << q;
      EXPECT_NEAR(a.transmittance, b.transmittance, 1e-12 * a.transmittance) << cut << ' ' << q;
    }
  }
}

// A dark layer under a clear one takes light away, most of all far from where it came in.
TEST(Slab, WhatLiesBelowShows) {
  Dipole material = make_material({0.01, 2}, DiffusionModel::better, 1.4, 2);
  material.below = {{{{1.0, 1.0}}, 0}};
  const auto half =
      make_reflectance_curve(make_material({0.01, 2}, DiffusionModel::better, 1.4), 0);
  const auto dark = make_reflectance_curve(material, 0);
  EXPECT_LT(total_of(dark), total_of(half));
  EXPECT_NEAR(eval_curve(dark, 0) / eval_curve(half, 0), 1, 0.05);
  EXPECT_LT(eval_curve(dark, 6), 0.7 * eval_curve(half, 6));
}

TEST(Slab, ErrorsSayWhatIsWrong) {
  const auto message = [](const Dipole& material) {
    return error_of([&] { make_reflectance_curve(material, 0); });
  };
  EXPECT_EQ(message(make_material({0.1, 2}, DiffusionModel::classic, 1.4, 0.2)),
            "thickness_mm: expected more than one transport mean free path 1 / (sigma_a + "
            "sigma_s') in all, found 0.42 of them");
  EXPECT_EQ(
      message(make_material({0.1, 2}, DiffusionModel::normalized, 1.4, 2)),
      "model: expected 'classic' or 'better' beside 'thickness_mm', found 'normalized', which "
      "has half-spaces only");
}

}  // namespace
}  // namespace parian
