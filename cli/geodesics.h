#pragma once
// carat geodesics: what its runs in one process and in several share.

#include <string>
#include <vector>

#include "carat/apps/heat_geodesics.h"
#include "cli/files.h"
#include "cli/operator_options.h"
#include "cli/session.h"

namespace carat::cli {

using SourceSets = std::vector<std::vector<GeodesicSource>>;

struct GeodesicsArguments {
  std::string input, output, sources_file;
  std::vector<Index> sources;
  bool each = false;
  double t_coef = 1;
  std::string edge_length = "max", directions = "samples", solver = "auto";
  OperatorOptions discretization;

  bool writes_matrix() const;
  /// The mesh with the direction of the one distance.
  bool writes_directions() const { return !output.empty() && !each; }
  HeatGeodesicsOptions heat() const;
  /// What is needed for the distances and for the output.
  DiscretizationParts parts() const;
};

/// \throws InvalidOption  no sources, a matrix of one distance
void check_sources(const GeodesicsArguments& arguments);
/// The vertices given one by one, and those of the file; with --each all by themselves.
SourceSets source_sets(const GeodesicsArguments& arguments, Index n_vertices);

/// The distance as a function that can be derived: 0 where it is infinite.
Vector finite(Vector distance);
/// Unit vectors along which the distance grows, from the means of its gradient in the elements.
Field direction_field(Points means);

void report_options(Session& session, const GeodesicsArguments& arguments, double time_step);
void report_distance(Session& session, const std::vector<Index>& unreachable, Index unresolved,
                     const Extremes& distance);

/// What many distances have in common.
struct DistanceSummary {
  Index sets = 0, incomplete_sets = 0;  // sets that do not reach all vertices
  std::int64_t unresolved_samples = 0;
  double largest = 0;
  Index largest_set = 0;

  void add(bool complete, Index unresolved, double largest_distance);
};
void report_each(Session& session, const DistanceSummary& summary, double seconds);
/// A matrix that was written, one row a source.
void report_matrix(Session& session, const std::string& path, Index rows, Index columns);

}  // namespace carat::cli
