#pragma once
// carat eigen: what its runs in one process and in several share.

#include <string>
#include <vector>

#include "carat/apps/eigenmodes.h"
#include "carat/mesh/fields.h"
#include "cli/operator_options.h"
#include "cli/session.h"

namespace carat::cli {

struct EigenArguments {
  std::string input, output, checkpoint, solver = "auto";
  Index count = 10;
  bool dirichlet = false;
  OperatorOptions discretization;
};

/// \throws InvalidOption  --dirichlet without a boundary
void check_boundary(const EigenArguments& arguments, bool has_boundary);
/// \param solver  the entry of this name
void report_pairs(Session& session, const EigenArguments& arguments, const EigenPairs& pairs,
                  Json solver);
/// The fields mode_1, mode_2, ...
std::vector<Field> mode_fields(const Matrix& vectors);

}  // namespace carat::cli
