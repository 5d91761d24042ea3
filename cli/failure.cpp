#include "cli/failure.h"

#include <algorithm>
#include <iostream>
#include <new>
#include <utility>

#include "carat/base/error.h"
#include "cli/session.h"

namespace carat::cli {
namespace {

std::pair<const char*, ExitCode> classify(const std::exception& error) {
  if (dynamic_cast<const InvalidOption*>(&error)) return {"invalid_option", kUsage};
  if (dynamic_cast<const IoError*>(&error)) return {"io", kInput};
  if (dynamic_cast<const InvalidMesh*>(&error)) return {"invalid_mesh", kInput};
  if (dynamic_cast<const DegenerateElement*>(&error)) return {"degenerate_element", kInput};
  if (dynamic_cast<const SolverFailure*>(&error)) return {"solver_failure", kNumerical};
  if (dynamic_cast<const OutOfMemory*>(&error) || dynamic_cast<const std::bad_alloc*>(&error))
    return {"out_of_memory", kNumerical};
  return {"internal", kNumerical};
}

std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  while (!message.empty() && message.back() == ' ') message.pop_back();
  return message;
}

}  // namespace

Failure describe_failure(const std::exception& error) {
  const auto [kind, exit_code] = classify(error);
  Failure failure{kind, exit_code, one_line(error.what()), {}};
  if (const auto* const own = dynamic_cast<const Error*>(&error)) {
    failure.elements = own->elements();
  } else if (failure.kind == std::string("out_of_memory")) {
    failure.message = "not enough memory; close other programs or use a smaller mesh";
  }
  return failure;
}

Failure usage_failure(const std::string& message) {
  return {"usage", kUsage, one_line(message), {}};
}

int report_failure(const Failure& failure, bool json) {
  std::cout.flush();
  // At once, as other processes may write to the same terminal.
  std::cerr << "carat: error: " + failure.message + '\n';
  if (json) {
    const Json object = {
        {"error",
         {{"kind", failure.kind},
          {"message", failure.message},
          {"elements", first_elements({failure.elements.begin(), failure.elements.end()})}}}};
    std::cout << object.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
  }
  return failure.exit_code;
}

}  // namespace carat::cli
