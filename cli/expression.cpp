#include "cli/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <regex>

#include "carat/base/error.h"
#include "cli/session.h"

namespace carat::cli {

struct Expression::Parser {
  std::string option, text;
  double x = 0, y = 0, z = 0;
  mu::Parser parser;

  /// e.g. --rhs 'sin(x'
  std::string name() const {
    constexpr std::size_t longest = 60;
    return option + " '" + (text.size() > longest ? text.substr(0, longest) + "..." : text) + "'";
  }

  [[noreturn]] void refuse(std::size_t position, const std::string& problem) const {
    throw InvalidOption(name() + ", character " + std::to_string(position + 1) + ": " + problem +
                        "; try e.g. \"sin(pi*x) + y^2\", and see --help for the functions");
  }

  /// muParser assigns to variables on "=", which is always meant as "==".
  void refuse_assignment() const {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '=') continue;
      if (i + 1 < text.size() && text[i + 1] == '=') {
        ++i;
      } else if (i == 0 || std::strchr("<>!", text[i - 1]) == nullptr) {
        refuse(i, "\"=\" assigns; compare with \"==\"");
      }
    }
  }

  void parse() {
    refuse_assignment();
    try {
      parser.DefineVar("x", &x);
      parser.DefineVar("y", &y);
      parser.DefineVar("z", &z);
      parser.DefineConst("pi", std::numbers::pi);
      parser.DefineConst("e", std::numbers::e);
      parser.SetExpr(text);
      parser.Eval();
    } catch (const mu::Parser::exception_type& error) {
      static const std::regex place(R"(( found)? at position \d+\.?|\.$)");
      std::string problem = std::regex_replace(error.GetMsg(), place, "");
      if (!problem.empty() && problem[0] >= 'A' && problem[0] <= 'Z')
        problem[0] = static_cast<char>(problem[0] - 'A' + 'a');
      const std::size_t position =
          error.GetPos() < 0 ? 0 : static_cast<std::size_t>(error.GetPos());
      refuse(std::min(position, text.size()), problem);
    }
    if (parser.GetNumResults() != 1)
      throw InvalidOption(name() + ": holds " + std::to_string(parser.GetNumResults()) +
                          " expressions; write one, without commas outside of functions");
  }
};

Expression::Expression(const std::string& option, const std::string& text)
    : parser_(std::make_shared<Parser>()) {
  parser_->option = option;
  parser_->text = text;
  parser_->parse();
}

double Expression::operator()(const Vec3& point) const {
  parser_->x = point.x();
  parser_->y = point.y();
  parser_->z = point.z();
  const double value = parser_->parser.Eval();
  if (!std::isfinite(value))
    throw InvalidOption(parser_->name() + " is " + cli::text(value) + " at (" +
                        cli::text(point.x()) + ", " + cli::text(point.y()) + ", " +
                        cli::text(point.z()) + "); it must be finite all over the mesh");
  return value;
}

Vector Expression::at(const Points& points) const {
  Vector values(points.rows());
  for (Eigen::Index v = 0; v < points.rows(); ++v) values[v] = (*this)(points.row(v).transpose());
  return values;
}

}  // namespace carat::cli
