#pragma once
// Numbers inside an HTML page: filtered so that they compress, deflated, base64. The inverse is
// viewer/src/blocks.ts.

#include <cstdint>
#include <ostream>
#include <span>
#include <string>

namespace carat::detail {

/// Bytes as base64, on one line.
std::string base64(std::span<const std::uint8_t> bytes);

/// Writes numbered <script type="application/octet-stream" id="block-N"> elements.
class BlockWriter {
 public:
  explicit BlockWriter(std::ostream& out) : out_(out) {}

  /// Bytes as they are. \return the block's number
  int write_bytes(std::span<const std::uint8_t> bytes);
  /// Byte planes: all first bytes, then all second bytes, ...
  int write_floats(std::span<const float> values);
  /// Differences to the predecessor (0 before the first), sign in the lowest bit, byte planes.
  int write_integers(std::span<const std::int32_t> values);

 private:
  std::ostream& out_;
  int n_blocks_ = 0;
};

}  // namespace carat::detail
