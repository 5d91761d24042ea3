#pragma once
// The figures of an experiment as files.

#include <string>
#include <vector>

#include "carat/report/html_view.h"
#include "cli/session.h"

namespace carat::cli {

/// Writes directory/ID.svg and directory/ID.png for every figure of an experiment; `surfaces` are
/// what those of kind "picture" show. All figures are
/// drawn before the first file is written.
/// \throws InvalidOption  a figure that does not fit the experiment: says which, and what is wrong
/// \throws IoError        a file cannot be written
void write_figures(const Json& experiment, const std::string& directory,
                   const std::vector<ViewItem>& surfaces = {});

}  // namespace carat::cli
