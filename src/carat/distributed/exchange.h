#pragma once
// Lists between all processes, and questions that the process answers which keeps the books. Seen
// by this folder's sources and tests alone.

#include <mpi.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "carat/base/types.h"
#include "carat/distributed/message.h"
#include "carat/distributed/processes.h"

namespace carat {

int own_rank();
int n_processes();

/// One list for, or from, each process.
template <class T>
using Lists = std::vector<std::vector<T>>;

/// Collective. Sends bytes to every process and gives what they sent. Goes in rounds that MPI can
/// count.
/// \param most  bytes of a round; what it takes beside the lists
Lists<char> exchange_bytes(const std::vector<std::span<const char>>& to,
                           std::size_t most = std::size_t{1} << 24);

/// Collective. The same for lists of values.
template <class T>
requires std::is_trivially_copyable_v<T> Lists<T> exchange(const Lists<T>& to) {
  std::vector<std::span<const char>> bytes;
  for (const std::vector<T>& list : to)
    bytes.emplace_back(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
  Lists<char> received = exchange_bytes(bytes);
  Lists<T> from;
  for (std::vector<char>& list : received) {
    from.emplace_back(list.size() / sizeof(T));
    if (!list.empty()) std::memcpy(from.back().data(), list.data(), list.size());
    list = {};
  }
  return from;
}

/// Collective. The same for messages.
std::vector<Message> exchange(const std::vector<Message>& to);
/// Collective. The messages of all processes, for small ones.
std::vector<Message> all_of(const Message& own);

/// Collective. The sum over all processes with a lower rank; `total` receives that over all.
std::int64_t sum_before(std::int64_t value, std::int64_t& total);
/// The same, entry by entry.
std::vector<std::int64_t> sums_before(const std::vector<std::int64_t>& values,
                                      std::vector<std::int64_t>& totals);
std::int64_t least_of_all(std::int64_t value);
std::int64_t most_of_all(std::int64_t value);

/// Consecutive numbers in equal blocks, one a process.
class Blocks {
 public:
  Blocks(std::int64_t first, std::int64_t last)
      : first_(first),
        width_((static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first)) /
                   static_cast<std::uint64_t>(n_processes()) +
               1) {}
  int owner(std::int64_t number) const {
    return static_cast<int>(
        (static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(first_)) / width_);
  }

 private:
  std::int64_t first_;
  std::uint64_t width_;
};

/// What a process asked, and where the answer goes.
template <class Question>
struct Asked {
  Question question;
  int process;
  std::size_t place;
};

/// Collective. Sends each question to the process owner(question), which answers all that it got:
/// answer(questions, reply), which does not communicate, calls reply(asked, value) for each. What
/// it throws all throw.
template <class Answer, class Question, class Owner, class Work>
std::vector<Answer> ask(const std::vector<Question>& questions, const Owner& owner,
                        const Work& answer) {
  Lists<Question> to(static_cast<std::size_t>(n_processes()));
  for (const Question& question : questions)
    to[static_cast<std::size_t>(owner(question))].push_back(question);
  Lists<Question> from = exchange(to);
  to.clear();
  Lists<Answer> answers(from.size());
  std::vector<Asked<Question>> asked;
  for (std::size_t p = 0; p < from.size(); ++p) {
    answers[p].resize(from[p].size());
    for (std::size_t k = 0; k < from[p].size(); ++k)
      asked.push_back({from[p][k], static_cast<int>(p), k});
    from[p] = {};
  }
  together([&] {
    answer(asked, [&](const Asked<Question>& to_whom, const Answer& value) {
      answers[static_cast<std::size_t>(to_whom.process)][to_whom.place] = value;
    });
  });
  asked = {};
  const Lists<Answer> got = exchange(answers);
  answers.clear();
  std::vector<Answer> result;
  result.reserve(questions.size());
  std::vector<std::size_t> next(got.size(), 0);
  for (const Question& question : questions) {
    const auto p = static_cast<std::size_t>(owner(question));
    result.push_back(got[p][next[p]++]);
  }
  return result;
}

/// \throws Shared<InvalidMesh>  n is more than Index and PetscInt can number
/// \param what  e.g. "vertices"
void check_count(std::int64_t n, const std::string& what);

}  // namespace carat
