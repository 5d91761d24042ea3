#pragma once
// What operators share: checks of options and of degenerate samples.

#include <string>
#include <vector>

#include "carat/operators/discretization.h"

namespace carat {

/// K at the centroid of a sample.
/// \throws InvalidOption  K is not a positive finite number there
double coefficient_at(const DiscretizationOptions& options, const Vec3& centroid);

/// Lists degenerate samples, or throws under DegeneratePolicy::Strict.
/// \param kind      "diamond", "virtual triangle", "face"
/// \param describe  the first sample in words: its vertices and its measure
/// \throws DegenerateElement
void report_degenerate(std::vector<Index> samples, const DiscretizationOptions& options,
                       const std::string& kind, const std::function<std::string(Index)>& describe,
                       Diagnostics& diagnostics);

/// Lists the vertices without a face: their rows and columns are empty.
void report_unreferenced(const PolygonMesh& mesh, Diagnostics& diagnostics);

/// Text of a number in an error message: shortest form that names the value.
std::string number(double value);

}  // namespace carat
