#pragma once
// What the literature promises of every operator, measured on any family of meshes.

#include <string>
#include <vector>

#include "carat/generators/families.h"
#include "carat/operators/registry.h"

namespace carat {

/// A property that an operator may be promised to have.
struct Claim {
  const char* name;   ///< as in reports
  const char* title;  ///< one line: what is measured
};

/// In the order of the table.
const std::vector<Claim>& claims();

enum class Verdict {
  Kept,      ///< promised, and it holds
  Denied,    ///< the literature denies it, and it fails here
  Holds,     ///< the literature denies it in general; it holds here
  Violated,  ///< promised, and it fails
  None,      ///< without meaning for this operator on this family
};

/// "kept", "denied", "holds", "violated", "none".
const char* verdict_name(Verdict verdict);

struct ClaimResult {
  const char* claim;
  Verdict verdict = Verdict::None;
  double measured = 0;  ///< defect relative to its natural size, a count, or a slope
  double limit = 0;     ///< the largest defect that is rounding; the count; the least slope
};

struct ClaimOptions {
  int level = 0;        ///< of the structural claims: all eigenvalues are computed
  double jitter = 0.2;  ///< of the same
  int threads = 0;
};

/// Measures every claim for an operator on a family. Empty where the operator is not defined on it.
///
/// Structural claims are measured on one mesh, the order of convergence on three finer ones, where
/// the family fills the unit square or cube or lies on the unit sphere.
/// \throws InvalidOption  a level so fine that all eigenvalues would take more than minutes
std::vector<ClaimResult> measure_claims(const SurfaceOperator& entry, const FamilyEntry& family,
                                        const ClaimOptions& options = {});
std::vector<ClaimResult> measure_claims(const VolumeOperator& entry,
                                        const VolumeFamilyEntry& family,
                                        const ClaimOptions& options = {});

}  // namespace carat
