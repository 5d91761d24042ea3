#pragma once
// A surface as an image: what a picture of an experiment shows.

#include "carat/mesh/polygon_mesh.h"
#include "cli/figure_image.h"

namespace carat::cli {

/// How values become colours.
struct ColorScale {
  double low = 0;
  double high = 1;
  int isolines = 0;  ///< dark lines, so many between low and high

  /// Beyond the ends the colours of the ends; grey for what is not finite.
  Color at(double value) const;
};

/// \param values  at the vertices
/// \return the surface from the front, a little from the right and from above, on white
Image render(const PolygonMesh& mesh, const Vector& values, const ColorScale& scale, int width,
             int height);

}  // namespace carat::cli
