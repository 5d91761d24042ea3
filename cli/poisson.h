#pragma once
// carat poisson: what its runs in one process and in several share.

#include <optional>
#include <string>
#include <vector>

#include "carat/apps/poisson.h"
#include "cli/boundary_data.h"
#include "cli/expression.h"
#include "cli/files.h"
#include "cli/operator_options.h"
#include "cli/session.h"

namespace carat::cli {

struct PoissonArguments {
  std::string input, output, solver = "auto", storage = "full";
  std::string rhs, coefficient_field;
  std::vector<std::string> dirichlet, neumann, robin;
  std::optional<std::string> dirichlet_where, coefficient, exact;
  OperatorOptions discretization;
};

/// The expressions that were given, parsed before any work is done.
struct PoissonExpressions {
  Expression rhs;
  BoundaryData boundary;
  std::optional<Expression> coefficient, exact;

  /// \throws InvalidOption
  explicit PoissonExpressions(const PoissonArguments& arguments);
};

void report_conditions(Session& session, const GivenConditions& conditions,
                       const std::string& side);
/// \param solver  the entry of this name
/// \param reason  why this solver, may be empty
void report_solution(Session& session, const PoissonSolution& solution, const Extremes& u,
                     Json solver, const std::string& reason);
void report_errors(Session& session, const ErrorNorms& errors);
/// That an operator has no gradient to write.
void note_no_gradient(Session& session, const std::string& operator_name);

}  // namespace carat::cli
