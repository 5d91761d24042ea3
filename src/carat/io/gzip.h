#pragma once
// Files packed with gzip.

#include "carat/base/memory.h"

namespace carat::detail {

/// The content of a .gz file.
/// \throws IoError  truncated or damaged
Array<char> unpack_gzip(const Array<char>& packed);

}  // namespace carat::detail
