#pragma once
// Arrays for bulk data: not zeroed on resize, and on huge pages where the system grants them.
// Page faults are a large part of a one-shot assembly (see docs/performance.md).

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace carat {

/// Bytes that can be allocated without swapping, as the system estimates; 0: unknown.
std::size_t available_memory();

/// The most bytes of main memory that the process has held, since it started or since
/// restart_peak_memory(); 0: unknown.
std::size_t peak_memory();
/// Gives memory that is free back and forgets the peak so far, where the system allows it.
void restart_peak_memory();

/// Asks the kernel to back [data, data + bytes) with huge pages. A hint: never fails.
void advise_huge_pages(void* data, std::size_t bytes);

namespace detail {
void* allocate_bulk(std::size_t bytes);
void free_bulk(void* data, std::size_t bytes) noexcept;
}  // namespace detail

/// Leaves trivial elements uninitialised on resize(n); large blocks lie on huge pages.
template <class T>
struct BulkAllocator {
  using value_type = T;
  BulkAllocator() = default;
  template <class U>
  BulkAllocator(const BulkAllocator<U>&) noexcept {}

  T* allocate(std::size_t n) {
    if (n > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(detail::allocate_bulk(n * sizeof(T)));
  }
  void deallocate(T* data, std::size_t n) noexcept { detail::free_bulk(data, n * sizeof(T)); }

  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(const BulkAllocator&, const BulkAllocator&) { return true; }
};

/// std::vector without the zeroing: resize(n) leaves the new elements unset.
template <class T>
using Array = std::vector<T, BulkAllocator<T>>;

}  // namespace carat
