#include "carat/distributed/matrix_rows.h"

#include <algorithm>

#include "carat/distributed/exchange.h"

namespace carat {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;  // entries that are sent together

}  // namespace

MatrixRows::MatrixRows(const std::vector<MatrixEntry>& entries, std::int64_t n_rows) {
  const Blocks blocks(0, std::max<std::int64_t>(n_rows - 1, 0));
  Lists<MatrixEntry> lists(static_cast<std::size_t>(n_processes()));
  for (const MatrixEntry& entry : entries)
    lists[static_cast<std::size_t>(blocks.owner(entry.row))].push_back(entry);
  for (const std::vector<MatrixEntry>& list : exchange(lists))
    entries_.insert(entries_.end(), list.begin(), list.end());
  // Stable: sums do not depend on who is faster.
  std::stable_sort(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  std::size_t n = 0;
  for (const MatrixEntry& entry : entries_) {
    if (n > 0 && entries_[n - 1].row == entry.row && entries_[n - 1].column == entry.column)
      entries_[n - 1].value += entry.value;
    else
      entries_[n++] = entry;
  }
  entries_.resize(n);
  n_entries_ = sum_of_all(static_cast<std::int64_t>(n));
}

void MatrixRows::visit(const std::function<void(const MatrixEntry&)>& visit) const {
  const auto for_pieces = [](std::size_t size, const auto& use) {
    for (std::size_t at = 0; at < size; at += kPiece) use(at, std::min(kPiece, size - at));
  };
  if (own_rank() > 0) {
    Message size;
    size.put(entries_.size());
    size.send(0);
    for_pieces(entries_.size(), [&](std::size_t at, std::size_t n) {
      Message message;
      message.put_list(
          std::vector<MatrixEntry>(entries_.begin() + static_cast<std::ptrdiff_t>(at),
                                   entries_.begin() + static_cast<std::ptrdiff_t>(at + n)));
      message.send(0);
    });
    return;
  }
  for (const MatrixEntry& entry : entries_) visit(entry);
  for (int process = 1; process < n_processes(); ++process) {
    Message message = Message::receive(process);
    std::size_t size = 0;
    message.take(size);
    for_pieces(size, [&](std::size_t, std::size_t) {
      std::vector<MatrixEntry> piece;
      message = Message::receive(process);
      message.take_list(piece);
      for (const MatrixEntry& entry : piece) visit(entry);
    });
  }
}

}  // namespace carat
