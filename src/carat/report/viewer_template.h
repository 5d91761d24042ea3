#pragma once
// The viewer's page without data, compiled into the target carat_viewer from viewer/.

#include <string_view>

namespace carat::detail {

/// The whole HTML page. Holds "<!--carat:title-->" once, where the escaped title belongs, and
/// "<!--carat:data-->" once, where the data elements belong.
std::string_view viewer_template();
/// The same for the page of experiments.
std::string_view report_template();

}  // namespace carat::detail
