#pragma once
// The cases that every claim is held to: operators x mesh families x levels, and variants.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"

namespace carat::test {

/// Where virtual vertices may lie, for operators that have them.
inline std::vector<VirtualPoint> virtual_points_of(const OperatorOptionSet& options) {
  if (!options.virtual_vertex) return {VirtualVertexRule{}.point};
  return {VirtualPoint::AreaMinimizer, VirtualPoint::Centroid, VirtualPoint::TraceMinimizer};
}

inline bool has_mass(const OperatorOptionSet& options, MassKind mass) {
  return std::find(options.masses.begin(), options.masses.end(), mass) != options.masses.end();
}

struct ClaimCase {
  const SurfaceOperator* entry;
  std::string family;
  FamilyOptions options;

  std::string name() const {
    std::string text =
        std::string(entry->name) + "_" + family + "_L" + std::to_string(options.level);
    if (options.jitter > 0) text += "_jittered";
    if (options.anisotropy > 1) text += "_anisotropic";
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
  }
  PolygonMesh mesh() const { return generate_mesh(family, options); }
  bool planar() const { return family.rfind("plane-", 0) == 0; }
  bool full_and_lumped() const {
    return has_mass(entry->options, MassKind::Full) && has_mass(entry->options, MassKind::Lumped);
  }
  bool triangles() const { return family.find("triangles") != std::string::npos; }
};

inline std::ostream& operator<<(std::ostream& out, const ClaimCase& c) { return out << c.name(); }

/// An operator runs on a family unless the literature defines it on triangles only.
inline bool defined_on(const SurfaceOperator& entry, const std::string& family) {
  return !entry.claims.simplices_only || family.find("triangles") != std::string::npos;
}

inline constexpr int kLevels = 3;
inline constexpr double kJitter = 0.2;
inline constexpr double kAnisotropy = 4;

/// Levels 0 .. kLevels-1, plus a jittered and an anisotropic variant at level 1.
inline std::vector<ClaimCase> claim_cases() {
  std::vector<ClaimCase> cases;
  for (const SurfaceOperator* entry : surface_operators())
    for (const FamilyEntry& family : mesh_families()) {
      if (!defined_on(*entry, family.name)) continue;
      for (int level = 0; level < kLevels; ++level)
        cases.push_back({entry, family.name, {.level = level}});
      cases.push_back({entry, family.name, {.level = 1, .jitter = kJitter, .seed = 7}});
      cases.push_back({entry, family.name, {.level = 1, .anisotropy = kAnisotropy}});
    }
  return cases;
}

template <class Keep>
std::vector<ClaimCase> claim_cases(const Keep& keep) {
  std::vector<ClaimCase> cases;
  for (const ClaimCase& c : claim_cases())
    if (keep(c)) cases.push_back(c);
  return cases;
}

inline std::string case_name(const testing::TestParamInfo<ClaimCase>& info) {
  return info.param.name();
}

class ClaimTest : public testing::TestWithParam<ClaimCase> {
 protected:
  Discretization discretization(const PolygonMesh& mesh, DiscretizationOptions options = {}) const {
    return discretize(mesh, GetParam().entry->name, options);
  }
};

}  // namespace carat::test
