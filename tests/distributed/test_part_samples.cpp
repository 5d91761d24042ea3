#include "carat/distributed/part_samples.h"
#include "carat/operators/part_discretization.h"
#include "parts.h"

namespace carat::test {
namespace {

/// Each row of the part is the row of the whole mesh that it is said to be, and all are there.
template <class Mesh>
void check(const Mesh& mesh, const std::string& name) {
  const Discretization whole = discretize(mesh, name);
  const auto part = own_part(mesh, scattered(n_elements(mesh), n_processes()));
  const Discretization own = discretize_part(part, name);
  const PartSamples samples = number_samples(part, own);
  // Interfaces count by their order alone.
  const PartSamples of_many = number_samples(with_first_interface(part, kManyInterfaces), own);
  EXPECT_EQ(of_many.numbers, samples.numbers);
  EXPECT_EQ(of_many.first_rows, samples.first_rows);
  EXPECT_EQ(of_many.n_samples, samples.n_samples);
  EXPECT_EQ(of_many.n_rows, samples.n_rows);
  ASSERT_EQ(samples.n_samples, whole.n_samples());
  ASSERT_EQ(samples.n_rows, whole.gradient.rows());
  const double scale = whole.gradient.coeffs().cwiseAbs().maxCoeff();
  std::int64_t n_own = 0;
  for (Index s = 0; s < own.n_samples(); ++s) {
    const std::int64_t number = samples.numbers[static_cast<std::size_t>(s)];
    if (number < 0) continue;
    ++n_own;
    const Index there = static_cast<Index>(number);
    ASSERT_EQ(samples.first_rows[static_cast<std::size_t>(s)], whole.first_row(there));
    EXPECT_NEAR(own.sample_measure[s], whole.sample_measure[there],
                1e-12 * whole.sample_measure.maxCoeff());
    for (Eigen::Index row = own.first_row(s); row < own.first_row(s + 1); ++row) {
      Vector difference = Vector::Zero(mesh.n_vertices());
      for (SparseMatrix::InnerIterator entry(own.gradient, row); entry; ++entry)
        difference[part.numbers.vertices[entry.col()]] += entry.value();
      for (SparseMatrix::InnerIterator entry(whole.gradient,
                                             row - own.first_row(s) + whole.first_row(there));
           entry; ++entry)
        difference[entry.col()] -= entry.value();
      EXPECT_LT(difference.lpNorm<Eigen::Infinity>(), 1e-11 * scale);
    }
  }
  EXPECT_EQ(sum_of_all(n_own), whole.n_samples());
}

TEST(PartSamples, are_numbered_as_in_the_whole_mesh) {
  for (const auto& [mesh_name, mesh] : surfaces_to_divide())
    for (const char* name : {"diamond", "stabilized_diamond", "bunge", "de_goes"}) {
      SCOPED_TRACE(mesh_name + " " + name);
      check(mesh, name);
    }
  for (const char* family : {"cube-tets", "ball-voronoi", "cube-hexahedra"}) {
    const PolyhedralMesh mesh = generate_volume(family, {.level = 0, .jitter = 0.2});
    for (const char* name : {"diamond", "stabilized_diamond", "bunge"}) {
      SCOPED_TRACE(std::string(family) + " " + name);
      check(mesh, name);
    }
  }
}

const WholeFinding* find(const std::vector<WholeFinding>& findings, const std::string& name) {
  for (const WholeFinding& finding : findings)
    if (finding.name == name) return &finding;
  return nullptr;
}

/// Which findings of an operator are of the interfaces of a mesh.
bool is_of_interfaces(const PolygonMesh&, const std::string&) { return false; }
bool is_of_interfaces(const PolyhedralMesh&, const std::string& finding) {
  return finding.ends_with("_virtual_vertices") || finding == "degenerate_faces";
}

template <class Mesh>
void check_findings(const Mesh& mesh, const std::string& name) {
  const Discretization whole = discretize(mesh, name);
  const auto part = own_part(mesh, scattered(n_elements(mesh), n_processes()));
  const Discretization own = discretize_part(part, name);
  const std::vector<WholeFinding> found = whole_diagnostics(part, own, false),
                                  of_many = whole_diagnostics(
                                      with_first_interface(part, kManyInterfaces), own, false);
  if (rank() > 0) {
    EXPECT_TRUE(found.empty());
  } else {
    for (const Finding& finding : whole.diagnostics.findings()) {
      SCOPED_TRACE(finding.name);
      std::vector<std::int64_t> elements(finding.elements.begin(), finding.elements.end());
      const WholeFinding* const same = find(found, finding.name);
      ASSERT_NE(same, nullptr);
      EXPECT_EQ(same->elements, elements);
      EXPECT_EQ(same->meaning, finding.meaning);
      if (is_of_interfaces(mesh, finding.name))
        for (std::int64_t& element : elements) element += kManyInterfaces;
      const WholeFinding* const beyond = find(of_many, finding.name);
      ASSERT_NE(beyond, nullptr);
      EXPECT_EQ(beyond->elements, elements);
    }
  }
  if (whole.diagnostics.count("excluded_samples") == 0) {
    whole_diagnostics(part, own, true);
    return;
  }
  try {
    whole_diagnostics(part, own, true);
    FAIL();
  } catch (const Shared<DegenerateElement>& error) {
    EXPECT_EQ(error.elements(), whole.diagnostics.find("excluded_samples")->elements);
  }
}

TEST(WholeDiagnostics, are_those_of_one_process) {
  for (const auto& [mesh_name, mesh] : surfaces_to_divide())
    for (const char* name : {"diamond", "bunge", "vem"}) {
      SCOPED_TRACE(mesh_name + " " + name);
      check_findings(mesh, name);
    }
  for (const auto& [mesh_name, mesh] : volumes_to_divide())
    for (const char* name : {"diamond", "bunge"}) {
      SCOPED_TRACE(mesh_name + " " + name);
      check_findings(mesh, name);
    }
}

}  // namespace
}  // namespace carat::test
