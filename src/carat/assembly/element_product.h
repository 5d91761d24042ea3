#pragma once
// Products with operators of virtual vertices, without their matrix.
//
// With P the affine weights of the elements (faces of a surface, cells of a volume) over their
// vertices, diamonds couple vertices with each other (A), vertices with the virtual vertices of
// their elements (B), and these with each other across edges or faces (C):
//   S = A + B^T P + P^T B + P^T C P.
// P^T C P alone couples all vertices of two elements; its factors have a few entries a corner. A
// product gathers P x and B x by element, adds what comes from across, and gathers by vertex, so
// that every value has one owner and one order of summation.

#include <mutex>

#include "carat/base/symmetric_operator.h"
#include "carat/base/types.h"

namespace carat {

/// Which vertices the elements have, and which elements lie beside them.
struct ElementStructure {
  Csr vertices;          ///< element -> its vertices: its *corners*
  Csr elements;          ///< vertex -> its elements
  Array<Index> corners;  ///< position in elements.indices -> corner
  Csr across;            ///< element -> elements across its sides; may repeat

  /// \param vertex_corners  vertex -> corners; \param corner_elements  corner -> element
  ElementStructure(const Csr& element_vertices, const Csr& vertex_corners,
                   const Array<Index>& corner_elements);
  Index n_elements() const { return vertices.n_rows(); }
};

/// P and B, in the orders of both gathers.
struct CornerTerms {
  struct Corner {
    double weight, own;
  };
  Array<Corner> by_element;
  Array<Corner> by_vertex;  ///< in the order of ElementStructure::elements

  /// \param weights, own  corner -> value of P, of B
  CornerTerms(const ElementStructure& structure, const Array<double>& weights,
              const Array<double>& own, int threads);
  CornerTerms(const ElementStructure& structure, Array<Corner> corners, int threads);
};

/// C, and whether B and what lies across take part: they do not in a mass.
struct ElementTerms {
  bool couples = false;
  Array<double> diagonal;  ///< element -> diagonal entry; empty: no elements
  Array<double>
      across;  ///< the negative of others, in the order of ElementStructure::across; empty without
};

class ElementProduct final : public SymmetricOperator {
 public:
  /// \param corners   P and B
  /// \param vertices  A
  ElementProduct(std::shared_ptr<const ElementStructure> structure,
                 std::shared_ptr<const CornerTerms> corners, SparseMatrix vertices,
                 std::shared_ptr<const ElementTerms> terms, int threads)
      : structure_(std::move(structure)),
        corners_(std::move(corners)),
        vertices_(std::move(vertices)),
        terms_(std::move(terms)),
        threads_(threads) {}

  Index rows() const override { return static_cast<Index>(vertices_.rows()); }
  void multiply(const double* x, double* y, Index k) const override;
  Vector diagonal() const override;
  Vector row_norms() const override;
  std::vector<Index> components() const override;
  std::shared_ptr<const SymmetricOperator> plus(const SparseMatrix& other) const override;
  bool assembled() const override { return false; }
  std::shared_ptr<const SparseMatrix> matrix() const override;
  std::size_t bytes() const override;

  /// a + t b of two operators of one mesh.
  static std::shared_ptr<const ElementProduct> sum(const ElementProduct& a, double t,
                                                   const ElementProduct& b);

 private:
  /// Values at elements, kept for their memory.
  class Scratch {
   public:
    explicit Scratch(const ElementProduct& owner);
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    double* reserve(std::size_t size);

   private:
    const ElementProduct& owner_;
    Array<double> values_;
  };
  bool has_elements() const { return !terms_->diagonal.empty(); }
  bool has_own() const { return terms_->couples; }
  template <bool kAbsolute, Index kWidth, Index kStride>
  void gather(const double* x, double* y, Index stride) const;

  std::shared_ptr<const ElementStructure> structure_;
  std::shared_ptr<const CornerTerms> corners_;
  SparseMatrix vertices_;  // A
  std::shared_ptr<const ElementTerms> terms_;
  int threads_;
  mutable std::mutex mutex_;
  mutable Array<double> spare_;  // between products
};

}  // namespace carat
