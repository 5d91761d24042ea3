#pragma once
// The interactive page of `carat reproduce`.

#include <filesystem>

#include "cli/session.h"

namespace carat::cli {

/// A self-contained page with all experiments of a report.
/// \throws IoError  the file cannot be written
void write_report_page(Json report, const std::filesystem::path& path);

}  // namespace carat::cli
