#include "carat/base/memory.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace carat {
namespace {
constexpr std::size_t kHugePage = std::size_t{2} << 20;
}

std::size_t available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  for (std::size_t kilobytes = 0; file >> key >> kilobytes; std::getline(file, unit))
    if (key == "MemAvailable:") return kilobytes * 1024;
  return 0;
}

void advise_huge_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  if (bytes < 2 * kHugePage) return;
  constexpr std::uintptr_t page = 4096;
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  const std::uintptr_t first = (begin + page - 1) / page * page;
  const std::uintptr_t last = (begin + bytes) / page * page;
  if (last > first)
    madvise(static_cast<char*>(data) + (first - begin), last - first, MADV_HUGEPAGE);
#endif
}

namespace detail {

void* allocate_bulk(std::size_t bytes) {
  void* data = nullptr;
  if (bytes < 2 * kHugePage) {
    data = std::malloc(bytes == 0 ? 1 : bytes);
  } else {
    const std::size_t rounded = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    if (rounded < bytes) throw std::bad_alloc();
    data = std::aligned_alloc(kHugePage, rounded);
    if (data != nullptr) advise_huge_pages(data, rounded);
  }
  if (data == nullptr) throw std::bad_alloc();
  return data;
}

void free_bulk(void* data, std::size_t) noexcept { std::free(data); }

}  // namespace detail
}  // namespace carat
