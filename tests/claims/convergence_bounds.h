#pragma once
// What the curvature and geodesics cases are held to, and why some do not converge. Bounds are the
// measured slopes less 0.1 and the measured errors of the finest level plus a quarter.

#include <string>

namespace carat::test {

struct ConvergenceBound {
  const char* problem;
  const char* key;  ///< operator, family, variant
  double least_slope;
  double largest_error;  ///< at the finest level
  const char* reason;    ///< why it is no better
};

inline constexpr const char* kConverges = "converges";
// The pointwise Laplacian converges in the weak sense only; pointwise it needs regular
// neighbourhoods: Hildebrandt, Polthier, Wardetzky 2006, "On the convergence of metric and
// geometric properties of polyhedral surfaces"; Wardetzky 2008, "Convergence of the cotangent
// formula: an overview".
inline constexpr const char* kIrregular = "pointwise curvature needs regular neighbourhoods";
// The same, at the vertices where two reflex corners meet; a full mass matrix amplifies it.
inline constexpr const char* kConcave = "pointwise curvature at reflex corners";
// Heat of the time h^2 is not resolved between vertices, so that directions of the gradients are
// wrong in a fixed part of the mesh. A longer time step converges: see the test with 16 h^2.
inline constexpr const char* kUnresolved = "t = h^2 is too short for this mesh";

inline constexpr ConvergenceBound kConvergenceBounds[] = {
    {"curvature", "diamond sphere-triangles", 1.35, 0.0013, kConverges},
    {"curvature", "diamond sphere-triangles jittered", -0.10, 0.038, kIrregular},
    {"curvature", "diamond sphere-quads", 1.45, 0.00055, kConverges},
    {"curvature", "diamond sphere-quads jittered", -0.20, 0.037, kIrregular},
    {"curvature", "diamond sphere-hexagons", 0.75, 0.003, kConverges},
    {"curvature", "diamond sphere-hexagons jittered", 0.05, 0.02, kIrregular},
    {"curvature", "diamond sphere-concave", -0.15, 0.33, kConcave},
    {"curvature", "diamond sphere-concave jittered", -0.15, 0.37, kConcave},
    {"curvature", "bunge sphere-triangles", 0.85, 0.015, kConverges},
    {"curvature", "bunge sphere-triangles jittered", 0.10, 0.063, kIrregular},
    {"curvature", "bunge sphere-quads", 0.85, 0.029, kConverges},
    {"curvature", "bunge sphere-quads jittered", 0.20, 0.091, kIrregular},
    {"curvature", "bunge sphere-hexagons", 0.40, 0.0083, kIrregular},
    {"curvature", "bunge sphere-hexagons jittered", -0.10, 0.15, kIrregular},
    {"curvature", "bunge sphere-concave", -0.15, 7, kConcave},
    {"curvature", "bunge sphere-concave jittered", -0.20, 8.5, kConcave},
    {"curvature", "cotan sphere-triangles", 0.85, 0.0063, kConverges},
    {"curvature", "cotan sphere-triangles jittered", 0.20, 0.022, kIrregular},
    {"geodesics", "diamond sphere-triangles", 0.70, 0.0026, kConverges},
    {"geodesics", "diamond sphere-triangles jittered", 0.90, 0.0018, kConverges},
    {"geodesics", "diamond sphere-quads", 0.80, 0.0081, kConverges},
    {"geodesics", "diamond sphere-quads jittered", 0.85, 0.0073, kConverges},
    {"geodesics", "diamond sphere-hexagons", 1.00, 0.0029, kConverges},
    {"geodesics", "diamond sphere-hexagons jittered", 1.00, 0.0033, kConverges},
    {"geodesics", "diamond sphere-concave", 0.15, 0.021, kUnresolved},
    {"geodesics", "diamond sphere-concave jittered", 0.75, 0.011, kConverges},
    {"geodesics", "bunge sphere-triangles", 0.60, 0.01, kConverges},
    {"geodesics", "bunge sphere-triangles jittered", 0.65, 0.0097, kConverges},
    {"geodesics", "bunge sphere-quads", 0.20, 0.025, kUnresolved},
    {"geodesics", "bunge sphere-quads jittered", 0.35, 0.018, kUnresolved},
    {"geodesics", "bunge sphere-hexagons", -0.10, 0.052, kUnresolved},
    {"geodesics", "bunge sphere-hexagons jittered", 0.00, 0.029, kUnresolved},
    {"geodesics", "bunge sphere-concave", -1.20, 1, kUnresolved},
    {"geodesics", "bunge sphere-concave jittered", -0.10, 0.12, kUnresolved},
    {"geodesics", "cotan sphere-triangles", 0.60, 0.0099, kConverges},
    {"geodesics", "cotan sphere-triangles jittered", 0.70, 0.0093, kConverges},
};

}  // namespace carat::test
