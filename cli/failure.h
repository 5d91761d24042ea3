#pragma once
// What went wrong, as the program reports it.

#include <exception>
#include <string>
#include <vector>

#include "carat/base/types.h"

namespace carat::cli {

enum ExitCode { kSuccess = 0, kUsage = 2, kInput = 3, kNumerical = 4 };

struct Failure {
  const char* kind;  ///< snake_case, stable, used in JSON
  ExitCode exit_code;
  std::string message;  ///< one line
  std::vector<Index> elements;
};

/// Reads an exception.
Failure describe_failure(const std::exception& error);

/// Prints the message on standard error and, if asked for, the object {"error": ...} on standard
/// output. \return the exit code
int report_failure(const Failure& failure, bool json);

/// A mistake on the command line that no typed error of the library describes.
Failure usage_failure(const std::string& message);

}  // namespace carat::cli
