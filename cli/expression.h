#pragma once
// Functions of x, y, z that the user typed.

#include <functional>
#include <memory>
#include <string>

#include "carat/base/types.h"

namespace carat::cli {

/// A parsed expression. Copies share the parser: not for concurrent use.
class Expression {
 public:
  /// \param option  where it was given, e.g. "--rhs"
  /// \throws InvalidOption  it does not parse; names the position and what is wrong
  Expression(const std::string& option, const std::string& text);

  /// \throws InvalidOption  the value is not finite; names the point
  double operator()(const Vec3& point) const;

  /// The value at every row.
  Vector at(const Points& points) const;

 private:
  struct Parser;
  std::shared_ptr<Parser> parser_;
};

}  // namespace carat::cli
