#pragma once
// Typed errors. A message is one line that says what is wrong, with which element, the value that
// was met, the limit, and what to do about it.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Base of everything this library throws on purpose.
class Error : public std::runtime_error {
 public:
  /// \param message   one line: what, which element, value, limit, remedy
  /// \param elements  ids (0-based) of the vertices, faces or samples concerned, if any
  explicit Error(const std::string& message, std::vector<Index> elements = {})
      : std::runtime_error(message), elements_(std::move(elements)) {}

  const std::vector<Index>& elements() const noexcept { return elements_; }

 private:
  std::vector<Index> elements_;
};

/// Connectivity or coordinates that are no mesh: index out of range, NaN, face of two vertices.
class InvalidMesh : public Error {
  using Error::Error;
};

/// An element whose measure vanishes where the caller asked for DegeneratePolicy::Strict.
class DegenerateElement : public Error {
  using Error::Error;
};

/// An argument outside what the function is defined for.
class InvalidOption : public Error {
  using Error::Error;
};

/// A file that cannot be read or written; the message starts with its path (and line).
class IoError : public Error {
  using Error::Error;
};

/// What does not fit into memory, said by who knows more than std::bad_alloc does.
class OutOfMemory : public Error {
  using Error::Error;
};

/// A linear system without a trustworthy solution: not positive definite, incompatible.
class SolverFailure : public Error {
  using Error::Error;
};

}  // namespace carat
