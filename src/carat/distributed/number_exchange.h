#pragma once
// Values at numbered things of which several processes hold the same: vertices, elements, edges.

#include <cstdint>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// Combines what processes know of things with numbers. Every number has a home, a process found
/// from the number alone, where values meet and from where they return: nobody needs to know who
/// else holds a number. Moves everything twice; for loops of solvers there is PartExchange.
class NumberExchange {
 public:
  /// Collective. \param numbers  what this process holds, not negative, in any order, none twice
  explicit NumberExchange(std::vector<std::int64_t> numbers);
  explicit NumberExchange(const Array<Index>& numbers)
      : NumberExchange(std::vector<std::int64_t>(numbers.begin(), numbers.end())) {}

  /// Collective. Sums over all processes, at the numbers held here; the same bits everywhere.
  /// \param values  one row a number held here; as many columns in all processes
  Matrix sum(const Matrix& values) const;
  /// Collective. Least values over all processes.
  std::vector<std::int64_t> least(const std::vector<std::int64_t>& values) const;
  /// Collective. Of all numbers that someone holds, in their order: the sums of the values of those
  /// before. \param values  at the numbers held here, the same in all processes that hold one
  /// \param total  receives the sum of all
  std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& values,
                                        std::int64_t& total) const;

 private:
  template <class Value>
  std::vector<Value> to_homes(const std::vector<Value>& values, int width) const;
  template <class Value>
  std::vector<Value> from_homes(const std::vector<Value>& values, int width) const;

  std::vector<int> home_;            // of each number held here
  std::vector<std::size_t> n_from_;  // at home: how many numbers came from each process
  std::vector<std::int64_t> met_;    // at home: place -> which of the distinct numbers, ascending
  std::int64_t n_distinct_ = 0;      // at home
};

}  // namespace carat
