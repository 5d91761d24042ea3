#pragma once
// Stiffness and mass of the diamond Laplacian as products, from the same terms as the matrices.

#include <memory>

#include "carat/assembly/diamond_assembly.h"
#include "carat/assembly/element_product.h"
#include "carat/assembly/pattern.h"
#include "carat/assembly/volume_diamond_assembly.h"
#include "carat/assembly/volume_pattern.h"

namespace carat {

/// Both operators of one mesh.
struct DiamondProducts {
  std::shared_ptr<const ElementProduct> stiffness, mass;
};

/// What follows from connectivity: the symbolic phase.
std::shared_ptr<ElementStructure> diamond_structure(const SurfaceIncidence& mesh);
std::shared_ptr<ElementStructure> diamond_structure(const VolumeIncidence& mesh);

/// \param structure  of the same mesh
/// Further as for assemble_diamonds(). With a lumped mass its operator is diagonal.
template <class Term>
DiamondProducts diamond_products(std::shared_ptr<const ElementStructure> structure,
                                 bool lumped_mass, const SurfaceIncidence& mesh,
                                 const Array<Term>& terms, const Array<Index>& edge_diamonds,
                                 const Array<double>& weights, int threads);

/// Pattern of what faces alone couple: the vertices of their common faces.
SparseMatrix interface_pattern(const VolumeIncidence& mesh, const Csr& vertex_corners,
                               const Array<Index>& corner_faces, int threads);

/// \param structure  of the same mesh
/// \param pattern    see interface_pattern()
/// Further as for assemble_volume_diamonds(); of the workspace, corners and faces are read.
DiamondProducts diamond_products(std::shared_ptr<const ElementStructure> structure,
                                 const SparseMatrix& pattern, bool lumped_mass,
                                 const VolumeIncidence& mesh, const Csr& vertex_corners,
                                 const Array<Index>& corner_faces,
                                 const Array<double>& face_weights,
                                 const Array<double>& cell_weights,
                                 const VolumeDiamondWorkspace& workspace, int threads);

}  // namespace carat
