#pragma once
// The cases that every claim about volume operators is held to: operators x mesh families x levels,
// regular and jittered.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"

namespace carat::test {

struct VolumeClaimCase {
  const VolumeOperator* entry;
  std::string family;
  FamilyOptions options;

  std::string name() const {
    std::string text =
        std::string(entry->name) + "_" + family + "_L" + std::to_string(options.level);
    if (options.jitter > 0) text += "_jittered";
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
  }
  PolyhedralMesh mesh() const { return generate_volume(family, options); }
  bool full_and_lumped() const {
    return std::count(entry->options.masses.begin(), entry->options.masses.end(), MassKind::Full) >
               0 &&
           std::count(entry->options.masses.begin(), entry->options.masses.end(),
                      MassKind::Lumped) > 0;
  }
  bool virtual_elements() const { return std::string(entry->name) == "vem"; }
  bool cube() const { return family.rfind("cube-", 0) == 0; }
};

inline std::ostream& operator<<(std::ostream& out, const VolumeClaimCase& c) {
  return out << c.name();
}

inline bool tetrahedral(const std::string& family) {
  return family.find("-tets") != std::string::npos;
}

/// Those that all claims are about: the others have unknowns beyond the vertices or negative
/// eigenvalues, and tests of their own in unit/test_ddfv.cpp and unit/test_dual_tet.cpp.
inline std::vector<const VolumeOperator*> claimed_volume_operators() {
  std::vector<const VolumeOperator*> operators;
  for (const VolumeOperator* entry : volume_operators())
    if (entry->claims.vertex_unknowns && entry->claims.semidefinite) operators.push_back(entry);
  return operators;
}

/// An operator runs on a family unless the literature defines it on tetrahedra only. Those with
/// unknowns beyond the vertices or without semidefiniteness have tests of their own:
/// unit/test_ddfv.cpp, unit/test_dual_tet.cpp.
inline bool defined_on(const VolumeOperator& entry, const std::string& family) {
  return entry.claims.vertex_unknowns && entry.claims.semidefinite &&
         (!entry.claims.simplices_only || tetrahedral(family));
}

inline constexpr double kVolumeJitter = 0.2;

/// Operators x families x the given levels, regular and jittered.
inline std::vector<VolumeClaimCase> volume_claim_cases(const std::vector<int>& levels) {
  std::vector<VolumeClaimCase> cases;
  for (const VolumeOperator* entry : volume_operators())
    for (const VolumeFamilyEntry& family : volume_families()) {
      if (!defined_on(*entry, family.name)) continue;
      for (const int level : levels)
        for (const double jitter : {0.0, kVolumeJitter})
          cases.push_back({entry, family.name, {.level = level, .jitter = jitter, .seed = 7}});
    }
  return cases;
}

template <class Keep>
std::vector<VolumeClaimCase> volume_claim_cases(const std::vector<int>& levels, const Keep& keep) {
  std::vector<VolumeClaimCase> cases;
  for (const VolumeClaimCase& c : volume_claim_cases(levels))
    if (keep(c)) cases.push_back(c);
  return cases;
}

inline std::string volume_case_name(const testing::TestParamInfo<VolumeClaimCase>& info) {
  return info.param.name();
}

class VolumeClaimTest : public testing::TestWithParam<VolumeClaimCase> {
 protected:
  Discretization discretization(const PolyhedralMesh& mesh,
                                DiscretizationOptions options = {}) const {
    return discretize(mesh, GetParam().entry->name, options);
  }
};

}  // namespace carat::test
