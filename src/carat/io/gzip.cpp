#include "carat/io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "carat/base/error.h"

namespace carat::detail {
namespace {

constexpr int kGzipHeader = 16 + MAX_WBITS;

struct Inflater {
  z_stream stream{};
  Inflater() {
    if (inflateInit2(&stream, kGzipHeader) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream); }
};

}  // namespace

Array<char> unpack_gzip(const Array<char>& packed) {
  Inflater inflater;
  z_stream& stream = inflater.stream;
  Array<char> content(4 * packed.size() + 64);
  std::size_t taken = 0, filled = 0;
  constexpr std::size_t kChunk = std::numeric_limits<uInt>::max();
  for (;;) {
    if (filled == content.size()) content.resize(2 * content.size());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(std::min(kChunk, packed.size() - taken));
    stream.next_out = reinterpret_cast<Bytef*>(content.data() + filled);
    stream.avail_out = static_cast<uInt>(std::min(kChunk, content.size() - filled));
    const uInt in = stream.avail_in, out = stream.avail_out;
    const int status = inflate(&stream, Z_NO_FLUSH);
    taken += in - stream.avail_in;
    filled += out - stream.avail_out;
    if (status == Z_STREAM_END) {
      // A file may consist of several packed parts.
      if (taken == packed.size()) break;
      inflateReset(&stream);
    } else if (status != Z_OK || (stream.avail_in == 0 && stream.avail_out > 0)) {
      throw IoError("cannot be unpacked; the .gz file is truncated or damaged");
    }
  }
  content.resize(filled);
  return content;
}

}  // namespace carat::detail
