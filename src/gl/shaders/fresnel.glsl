// Transmission of unpolarised light from outside into index eta (transport/irradiance.h).
float fresnel_transmission(float eta, float cosine) {
  if (cosine <= 0.0) return 0.0;
  float cos_i = min(cosine, 1.0);
  float sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1.0) return eta == 1.0 ? 1.0 : 0.0;
  float cos_t = sqrt(1.0 - sin2_t);
  float s = 1.0 / (cos_i + eta * cos_t), p = 1.0 / (eta * cos_i + cos_t);
  return 2.0 * eta * cos_i * cos_t * (s * s + p * p);
}
