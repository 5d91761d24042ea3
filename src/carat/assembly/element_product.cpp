#include "carat/assembly/element_product.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carat/base/column_blocks.h"
#include "carat/base/parallel.h"

namespace carat {
namespace {

Array<double> combined(const Array<double>& a, double t, const Array<double>& b) {
  if (b.empty()) return a;
  Array<double> sum(b.size());
  for (std::size_t k = 0; k < b.size(); ++k) sum[k] = (a.empty() ? 0.0 : a[k]) + t * b[k];
  return sum;
}

/// Asks for what will be read soon: in short loops the processor itself looks less far ahead. The
/// distance is the best of 512 to 4096 bytes on hexagons that costs hexahedra nothing.
constexpr std::ptrdiff_t kAhead = 1024;
inline void fetch([[maybe_unused]] const void* data) {
#if defined(__GNUC__)
  __builtin_prefetch(static_cast<const char*>(data) + kAhead);
#endif
}

/// Sets of rows.
class Components {
 public:
  explicit Components(Index n)
      : parent_(static_cast<std::size_t>(n)), coupled_(static_cast<std::size_t>(n), false) {
    for (Index i = 0; i < n; ++i) parent_[i] = i;
  }
  void join(Index a, Index b) {
    coupled_[a] = coupled_[b] = true;
    a = root(a);
    b = root(b);
    // The lower number leads, so that no order of joining matters.
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Index> numbers() {
    std::vector<Index> number(parent_.size(), -1);
    Index count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      if (!coupled_[i]) continue;
      const Index lead = root(static_cast<Index>(i));
      if (number[lead] < 0) number[lead] = count++;
      number[i] = number[lead];
    }
    return number;
  }

 private:
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<Index> parent_;
  std::vector<bool> coupled_;
};

}  // namespace

ElementStructure::ElementStructure(const Csr& element_vertices, const Csr& vertex_corners,
                                   const Array<Index>& corner_elements)
    : vertices(element_vertices), corners(vertex_corners.indices) {
  elements.offsets = vertex_corners.offsets;
  elements.indices.resize(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k)
    elements.indices[k] = corner_elements[corners[k]];
}

CornerTerms::CornerTerms(const ElementStructure& structure, const Array<double>& weights,
                         const Array<double>& own, int threads)
    : CornerTerms(
          structure,
          [&] {
            Array<Corner> corners(weights.size());
            for (std::size_t c = 0; c < corners.size(); ++c) corners[c] = {weights[c], own[c]};
            return corners;
          }(),
          threads) {}

CornerTerms::CornerTerms(const ElementStructure& structure, Array<Corner> corners, int threads)
    : by_element(std::move(corners)), by_vertex(by_element.size()) {
  parallel_blocks(static_cast<Index>(by_vertex.size()), threads, [&](int, Index begin, Index end) {
    for (Index k = begin; k < end; ++k) by_vertex[k] = by_element[structure.corners[k]];
  });
}

ElementProduct::Scratch::Scratch(const ElementProduct& owner) : owner_(owner) {
  const std::lock_guard lock(owner_.mutex_);
  std::swap(values_, owner_.spare_);
}
ElementProduct::Scratch::~Scratch() {
  const std::lock_guard lock(owner_.mutex_);
  std::swap(values_, owner_.spare_);
}
double* ElementProduct::Scratch::reserve(std::size_t size) {
  if (values_.size() < size) values_ = Array<double>(size);
  return values_.data();
}

/// \tparam kAbsolute  of the absolute values of all factors
/// \tparam kWidth     vectors that are multiplied
/// \tparam kStride    values a row of x and y; 0: stride_of_x
template <bool kAbsolute, Index kWidth, Index kStride>
void ElementProduct::gather(const double* x, double* y, Index stride_of_x) const {
  using Values = Eigen::Array<double, kWidth, 1>;
  using Loaded = Eigen::Map<const Values>;
  using Stored = Eigen::Map<Values>;
  const ElementStructure& structure = *structure_;
  const ElementTerms& terms = *terms_;
  const auto stride = static_cast<std::size_t>(kStride > 0 ? kStride : stride_of_x);
  const auto value = [](double v) { return kAbsolute ? std::abs(v) : v; };
  const auto of_row = [&](Index row) { return x + stride * static_cast<std::size_t>(row); };
  // Of every element: the factor of its weights, then P x.
  Scratch scratch(*this);
  double* const elements = scratch.reserve(2 * kWidth * terms.diagonal.size());
  const auto of_element = [&](Index e) {
    return elements + 2 * kWidth * static_cast<std::size_t>(e);
  };
  const bool own = has_own();
  if (has_elements()) {
    parallel_blocks(structure.n_elements(), threads_, [&](int, Index begin, Index end) {
      const Index* const vertices = structure.vertices.indices.data();
      const CornerTerms::Corner* const corners = corners_->by_element.data();
      for (Index e = begin; e < end; ++e) {
        Values mean = Values::Zero(), coupled = Values::Zero();
        const Index last = structure.vertices.end(e);
        for (Index c = structure.vertices.begin(e); c < last; ++c) {
          fetch(corners + c);
          const Loaded at(of_row(vertices[c]));
          mean += value(corners[c].weight) * at;
          coupled += value(corners[c].own) * at;
        }
        if (!own) coupled.setZero();
        Stored(of_element(e)) = coupled + value(terms.diagonal[e]) * mean;
        Stored(of_element(e) + kWidth) = mean;
      }
    });
  }
  if (own) {
    parallel_blocks(structure.n_elements(), threads_, [&](int, Index begin, Index end) {
      const Index* const others = structure.across.indices.data();
      const double* const across = terms.across.data();
      for (Index e = begin; e < end; ++e) {
        Values sum = Values::Zero();
        const Index last = structure.across.end(e);
        for (Index k = structure.across.begin(e); k < last; ++k)
          sum += value(across[k]) * Loaded(of_element(others[k]) + kWidth);
        if constexpr (kAbsolute)
          Stored(of_element(e)) += sum;
        else
          Stored(of_element(e)) -= sum;
      }
    });
  }
  const bool with_elements = has_elements();
  parallel_blocks(rows(), threads_, [&](int, Index begin, Index end) {
    const Index* const offsets = vertices_.outerIndexPtr();
    const Index* const columns = vertices_.innerIndexPtr();
    const double* const values = vertices_.valuePtr();
    const Index* const of_vertex = structure.elements.indices.data();
    const CornerTerms::Corner* const corners = corners_->by_vertex.data();
    for (Index row = begin; row < end; ++row) {
      Values sum = Values::Zero(), coupled = Values::Zero();
      for (Index k = offsets[row]; k < offsets[row + 1]; ++k) {
        fetch(values + k);
        sum += value(values[k]) * Loaded(of_row(columns[k]));
      }
      if (with_elements) {
        const Index last = structure.elements.end(row);
        for (Index k = structure.elements.begin(row); k < last; ++k) {
          fetch(corners + k);
          const double* const at = of_element(of_vertex[k]);
          sum += value(corners[k].weight) * Loaded(at);
          if (own) coupled += value(corners[k].own) * Loaded(at + kWidth);
        }
      }
      Stored(y + stride * static_cast<std::size_t>(row)) = sum + coupled;
    }
  });
}

void ElementProduct::multiply(const double* x, double* y, Index k) const {
  for_column_groups(k, [&](auto width, Index first) {
    if (k == 1)
      gather<false, 1, 1>(x, y, k);
    else
      gather<false, decltype(width)::value, 0>(x + first, y + first, k);
  });
}

Vector ElementProduct::row_norms() const {
  const Vector ones = Vector::Ones(rows());
  Vector norms(rows());
  gather<true, 1, 1>(ones.data(), norms.data(), 1);
  return norms;
}

Vector ElementProduct::diagonal() const {
  const ElementStructure& structure = *structure_;
  const ElementTerms& terms = *terms_;
  Vector result = vertices_.diagonal();
  if (!has_elements()) return result;
  parallel_blocks(rows(), threads_, [&](int, Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      const Index first = structure.elements.begin(row), last = structure.elements.end(row);
      // Weights of the vertex in the element of one of its corners and in those across. A face may
      // have a vertex twice.
      for (Index k = first; k < last; ++k) {
        const Index e = structure.elements.indices[k];
        double factor = 0;
        for (Index other = first; other < last; ++other) {
          const Index its = structure.elements.indices[other];
          const auto [weight, own] = corners_->by_vertex[other];
          if (its == e) factor += terms.diagonal[e] * weight + (has_own() ? 2 * own : 0.0);
          if (!has_own()) continue;
          for (Index m = structure.across.begin(e); m < structure.across.end(e); ++m)
            if (structure.across.indices[m] == its) factor -= terms.across[m] * weight;
        }
        result[row] += corners_->by_vertex[k].weight * factor;
      }
    }
  });
  return result;
}

std::vector<Index> ElementProduct::components() const {
  const ElementStructure& structure = *structure_;
  const ElementTerms& terms = *terms_;
  Components components(rows());
  // One vertex of every element that takes part.
  Array<Index> of_element(terms.diagonal.size());
  for (Index e = 0; e < static_cast<Index>(of_element.size()); ++e) {
    of_element[e] = -1;
    bool coupled = terms.diagonal[e] != 0;
    for (Index c = structure.vertices.begin(e); c < structure.vertices.end(e) && !coupled; ++c)
      coupled = has_own() && corners_->by_element[c].own != 0;
    if (!coupled) continue;
    for (Index c = structure.vertices.begin(e); c < structure.vertices.end(e); ++c) {
      const auto [weight, own] = corners_->by_element[c];
      if (weight == 0 && (!has_own() || own == 0)) continue;
      const Index v = structure.vertices.indices[c];
      if (of_element[e] < 0) of_element[e] = v;
      components.join(of_element[e], v);
    }
  }
  if (has_own())
    for (Index e = 0; e < structure.n_elements(); ++e)
      for (Index k = structure.across.begin(e); k < structure.across.end(e); ++k) {
        const Index other = structure.across.indices[k];
        if (other < e && terms.across[k] != 0 && of_element[e] >= 0 && of_element[other] >= 0)
          components.join(of_element[e], of_element[other]);
      }
  for (Index row = 0; row < rows(); ++row)
    for (SparseMatrix::InnerIterator entry(vertices_, row); entry; ++entry)
      if (entry.col() <= row && entry.value() != 0) components.join(row, entry.col());
  return components.numbers();
}

std::shared_ptr<const SymmetricOperator> ElementProduct::plus(const SparseMatrix& other) const {
  return std::make_shared<ElementProduct>(structure_, corners_, SparseMatrix(vertices_ + other),
                                          terms_, threads_);
}

std::shared_ptr<const ElementProduct> ElementProduct::sum(const ElementProduct& a, double t,
                                                          const ElementProduct& b) {
  ElementTerms terms{a.has_own() || b.has_own(),
                     combined(a.terms_->diagonal, t, b.terms_->diagonal),
                     combined(a.terms_->across, t, b.terms_->across)};
  Array<CornerTerms::Corner> corners = a.corners_->by_element;
  for (std::size_t c = 0; c < corners.size(); ++c)
    corners[c].own = (a.has_own() ? corners[c].own : 0.0) +
                     (b.has_own() ? t * b.corners_->by_element[c].own : 0.0);
  return std::make_shared<ElementProduct>(
      a.structure_, std::make_shared<CornerTerms>(*a.structure_, std::move(corners), a.threads_),
      SparseMatrix(a.vertices_ + t * b.vertices_), std::make_shared<ElementTerms>(std::move(terms)),
      a.threads_);
}

std::shared_ptr<const SparseMatrix> ElementProduct::matrix() const {
  auto result = std::make_shared<SparseMatrix>(vertices_);
  if (!has_elements()) return result;
  const Index n_elements = structure_->n_elements();
  using Entries = std::vector<Eigen::Triplet<double, Index>>;
  const auto of_corners = [&](double CornerTerms::Corner::*value) {
    Entries entries;
    for (Index e = 0; e < n_elements; ++e)
      for (Index c = structure_->vertices.begin(e); c < structure_->vertices.end(e); ++c)
        entries.emplace_back(e, structure_->vertices.indices[c], corners_->by_element[c].*value);
    SparseMatrix matrix(n_elements, rows());
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  };
  Entries entries;
  for (Index e = 0; e < n_elements; ++e) {
    entries.emplace_back(e, e, terms_->diagonal[e]);
    if (has_own())
      for (Index k = structure_->across.begin(e); k < structure_->across.end(e); ++k)
        entries.emplace_back(e, structure_->across.indices[k], -terms_->across[k]);
  }
  SparseMatrix between(n_elements, n_elements);
  between.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrix p = of_corners(&CornerTerms::Corner::weight);
  const SparseMatrix::Plain transposed = p.transpose();
  *result += SparseMatrix::Plain(transposed * SparseMatrix::Plain(between * p));
  if (has_own()) {
    const SparseMatrix::Plain mixed = transposed * of_corners(&CornerTerms::Corner::own);
    *result += mixed;
    *result += SparseMatrix::Plain(mixed.transpose());
  }
  return result;
}

std::size_t ElementProduct::bytes() const {
  const auto of = [](const auto& array) {
    return array.size() * sizeof(typename std::decay_t<decltype(array)>::value_type);
  };
  std::size_t bytes =
      static_cast<std::size_t>(vertices_.nonZeros()) * (sizeof(double) + sizeof(Index)) +
      (static_cast<std::size_t>(rows()) + 1) * sizeof(Index);
  if (!has_elements()) return bytes;
  for (const Csr* const rows : {&structure_->vertices, &structure_->elements})
    bytes += of(rows->offsets) + of(rows->indices);
  if (has_own()) bytes += of(structure_->across.offsets) + of(structure_->across.indices);
  return bytes + 2 * of(corners_->by_element) + of(terms_->diagonal) + of(terms_->across);
}

}  // namespace carat
