#include "carat/base/memory.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace carat {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

/// A value of lines "key: number kB".  [bytes]
std::size_t kilobytes_in(const char* path, const std::string& wanted) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(wanted))
      return std::strtoull(line.c_str() + wanted.size(), nullptr, 10) * 1024;
  return 0;
}

}  // namespace

std::size_t available_memory() { return kilobytes_in("/proc/meminfo", "MemAvailable:"); }

std::size_t peak_memory() { return kilobytes_in("/proc/self/status", "VmHWM:"); }

void restart_peak_memory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
  std::ofstream("/proc/self/clear_refs") << 5;
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
