#pragma once
// Errors that name the file.

#include <filesystem>
#include <new>

#include "carat/base/error.h"

namespace carat::detail {

/// Runs `work` and puts the path in front of what it throws.
template <class Work>
auto with_path(const std::filesystem::path& path, Work&& work) {
  // Made where it is needed alone: the work may be that of one cell.
  const auto prefixed = [&](const char* what) { return path.string() + ": " + what; };
  try {
    return work();
  } catch (const IoError& error) {
    throw IoError(prefixed(error.what()), error.elements());
  } catch (const InvalidMesh& error) {
    throw InvalidMesh(prefixed(error.what()), error.elements());
  } catch (const InvalidOption& error) {
    throw InvalidOption(prefixed(error.what()), error.elements());
  } catch (const std::bad_alloc&) {
    throw IoError(prefixed(
        "does not fit into memory; close other programs, or use a smaller mesh or more processes"));
  }
}

}  // namespace carat::detail
