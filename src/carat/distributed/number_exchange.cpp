#include "carat/distributed/number_exchange.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "carat/distributed/exchange.h"

namespace carat {

NumberExchange::NumberExchange(std::vector<std::int64_t> numbers) {
  const std::int64_t largest = most_of_all(
      numbers.empty() ? std::int64_t{0} : *std::max_element(numbers.begin(), numbers.end()));
  // Homes ascend with the numbers.
  const Blocks homes(0, largest);
  home_.reserve(numbers.size());
  for (const std::int64_t number : numbers) home_.push_back(homes.owner(number));
  Lists<std::int64_t> lists(static_cast<std::size_t>(n_processes()));
  for (std::size_t k = 0; k < numbers.size(); ++k)
    lists[static_cast<std::size_t>(home_[k])].push_back(numbers[k]);
  for (const std::vector<std::int64_t>& list : exchange(lists)) {
    n_from_.push_back(list.size());
    met_.insert(met_.end(), list.begin(), list.end());
  }
  std::vector<std::int64_t> distinct = met_;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  n_distinct_ = static_cast<std::int64_t>(distinct.size());
  for (std::int64_t& number : met_)
    number = std::lower_bound(distinct.begin(), distinct.end(), number) - distinct.begin();
}

template <class Value>
std::vector<Value> NumberExchange::to_homes(const std::vector<Value>& values, int width) const {
  const std::ptrdiff_t w = width;
  Lists<Value> lists(static_cast<std::size_t>(n_processes()));
  auto row = values.begin();
  for (const int home : home_) {
    std::vector<Value>& list = lists[static_cast<std::size_t>(home)];
    list.insert(list.end(), row, row + w);
    row += w;
  }
  std::vector<Value> result;
  result.reserve(met_.size() * static_cast<std::size_t>(width));
  for (const std::vector<Value>& list : exchange(lists))
    result.insert(result.end(), list.begin(), list.end());
  return result;
}

template <class Value>
std::vector<Value> NumberExchange::from_homes(const std::vector<Value>& values, int width) const {
  const std::ptrdiff_t w = width;
  Lists<Value> lists(n_from_.size());
  auto met = met_.begin();
  for (std::size_t process = 0; process < lists.size(); ++process)
    for (std::size_t k = 0; k < n_from_[process]; ++k, ++met)
      lists[process].insert(lists[process].end(), values.begin() + w * *met,
                            values.begin() + w * (*met + 1));
  const Lists<Value> received = exchange(lists);
  std::vector<std::ptrdiff_t> next(received.size(), 0);
  std::vector<Value> result;
  result.reserve(home_.size() * static_cast<std::size_t>(width));
  for (const int home : home_) {
    const std::vector<Value>& list = received[static_cast<std::size_t>(home)];
    std::ptrdiff_t& at = next[static_cast<std::size_t>(home)];
    result.insert(result.end(), list.begin() + at, list.begin() + at + w);
    at += w;
  }
  return result;
}

Matrix NumberExchange::sum(const Matrix& values) const {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int width = static_cast<int>(values.cols());
  const Rows rows = values;
  const std::vector<double> here =
      to_homes(std::vector<double>(rows.data(), rows.data() + rows.size()), width);
  const std::size_t w = static_cast<std::size_t>(width);
  std::vector<double> sums(static_cast<std::size_t>(n_distinct_) * w, 0);
  for (std::size_t place = 0; place < met_.size(); ++place)
    for (std::size_t j = 0; j < w; ++j)
      sums[w * static_cast<std::size_t>(met_[place]) + j] += here[w * place + j];
  const std::vector<double> result = from_homes(sums, width);
  return Eigen::Map<const Rows>(result.data(), values.rows(), values.cols());
}

std::vector<std::int64_t> NumberExchange::least(const std::vector<std::int64_t>& values) const {
  const std::vector<std::int64_t> here = to_homes(values, 1);
  std::vector<std::int64_t> least(static_cast<std::size_t>(n_distinct_),
                                  std::numeric_limits<std::int64_t>::max());
  for (std::size_t place = 0; place < met_.size(); ++place) {
    std::int64_t& value = least[static_cast<std::size_t>(met_[place])];
    value = std::min(value, here[place]);
  }
  return from_homes(least, 1);
}

std::vector<std::int64_t> NumberExchange::sums_before(const std::vector<std::int64_t>& values,
                                                      std::int64_t& total) const {
  const std::vector<std::int64_t> here = to_homes(values, 1);
  std::vector<std::int64_t> sums(static_cast<std::size_t>(n_distinct_), 0);
  for (std::size_t place = 0; place < met_.size(); ++place)
    sums[static_cast<std::size_t>(met_[place])] = here[place];
  const std::int64_t before =
      sum_before(std::accumulate(sums.begin(), sums.end(), std::int64_t{0}), total);
  std::exclusive_scan(sums.begin(), sums.end(), sums.begin(), before);
  return from_homes(sums, 1);
}

}  // namespace carat
