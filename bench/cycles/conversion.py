"""One homogeneous material in the words of Parian's dipole and of Cycles' subsurface scattering.

Both sides are index-matched (eta = 1: no Fresnel factors, no reflection on top), so that radiance
is M / pi with M the integral of R_d times irradiance, in Parian and in Cycles alike.

Given sigma_a and sigma_s' in 1/mm, Parian's dipole (Jensen et al. 2001) has
    sigma_t' = sigma_a + sigma_s',  diffuse albedo rho = 2 pi int R_d r dr,  mean distance
    r_mean = 2 pi int R_d r^2 dr / rho.
Cycles 3.4 takes a colour, which is rho, and a radius in each channel:
  Christensen-Burley       R = rho (e^{-r/d} + e^{-r/3d}) / (8 pi d r), d = radius / (4 pi s(rho)),
                           s = 1.9 - rho + 3.5 (rho - 0.8)^2 (their equation 6). Its mean distance
                           is 2.5 d: radius = 4 pi s(rho) r_mean / 2.5 gives Parian's.
  Random walk (fixed)      walks with mean free path radius / (4 pi), and finds the albedo of single
                           scattering from rho: radius = 4 pi / sigma_t'. (The other random walk
                           takes 1 / sigma_tr and inverts the dipole itself, but in twelve
                           bisections, too coarse for albedos as high as marble's.)
"""

import math

import numpy

ETA = 1.0


def boundary_factor(eta):
    fresnel = -1.440 / eta**2 + 0.710 / eta + 0.668 + 0.0636 * eta
    return (1 + fresnel) / (1 - fresnel)


def dipole_moments(sigma_a, sigma_s_prime, eta=ETA):
    """(rho, r_mean in mm) of one channel, by quadrature on a logarithmic grid."""
    sigma_t = sigma_a + sigma_s_prime
    sigma_tr = math.sqrt(3 * sigma_a * sigma_t)
    r = numpy.geomspace(1e-5 / sigma_t, 60 / sigma_tr, 200000)

    def source(z):
        distance = numpy.hypot(r, z)
        return z * (sigma_tr + 1 / distance) * numpy.exp(-sigma_tr * distance) / distance**2

    depth = 1 / sigma_t
    reflectance = sigma_s_prime / sigma_t / (4 * math.pi) * (
        source(depth) + source(depth * (1 + 4 / 3 * boundary_factor(eta))))
    weight = 2 * math.pi * reflectance * r * r  # one r is of d(ln r)
    step = math.log(r[1] / r[0])
    rho = float(weight.sum() * step)
    return rho, float((weight * r).sum() * step) / rho


def cycles_materials(sigma_a, sigma_s_prime):
    """Colour and radii for each falloff, from coefficients of three channels."""
    moments = [dipole_moments(a, s) for a, s in zip(sigma_a, sigma_s_prime)]
    color = [rho for rho, _ in moments]
    burley = [4 * math.pi * (1.9 - rho + 3.5 * (rho - 0.8)**2) * mean / 2.5
              for rho, mean in moments]
    walk = [4 * math.pi / (a + s) for a, s in zip(sigma_a, sigma_s_prime)]
    return {"BURLEY": {"color": color, "radius_mm": burley},
            "RANDOM_WALK_FIXED_RADIUS": {"color": color, "radius_mm": walk}}
