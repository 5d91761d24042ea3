#pragma once
// What a computation met that its user should know: never printed by the library, always returned.

#include <string>
#include <utility>
#include <vector>

#include "carat/base/types.h"

namespace carat {

/// One kind of finding with the elements concerned, e.g. "excluded_diamonds": edges 3, 17.
struct Finding {
  std::string name;             ///< snake_case key, stable, used in JSON
  std::string meaning;          ///< one sentence: what it is and what was done about it
  std::vector<Index> elements;  ///< 0-based ids, ascending
};

/// Findings of one result, in the order they were made. Empty kinds are kept: a count of 0 is news.
class Diagnostics {
 public:
  void add(std::string name, std::string meaning, std::vector<Index> elements) {
    findings_.push_back({std::move(name), std::move(meaning), std::move(elements)});
  }
  /// Number of elements under `name`; 0 if it was never looked for.
  Index count(const std::string& name) const {
    const Finding* finding = find(name);
    return finding == nullptr ? 0 : static_cast<Index>(finding->elements.size());
  }
  const Finding* find(const std::string& name) const {
    for (const Finding& finding : findings_)
      if (finding.name == name) return &finding;
    return nullptr;
  }
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

}  // namespace carat
