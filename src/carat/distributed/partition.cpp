#include "carat/distributed/partition.h"

#include <scotch.h>

#include <algorithm>
#include <cstdio>  // scotch.h names FILE
#include <limits>
#include <string>

#include "carat/base/error.h"

namespace carat {
namespace {

/// Elements that share interfaces, each pair once from either side; weights: how many they share.
struct ElementGraph {
  std::vector<SCOTCH_Num> offsets{0}, neighbours, weights;
};

/// \param for_neighbours  for_neighbours(element, visit) visits those across every interface
template <class ForNeighbours>
ElementGraph element_graph(Index n_elements, const ForNeighbours& for_neighbours) {
  ElementGraph graph;
  std::vector<Index> across;
  for (Index element = 0; element < n_elements; ++element) {
    across.clear();
    for_neighbours(element, [&](Index other) {
      if (other != element) across.push_back(other);
    });
    std::sort(across.begin(), across.end());
    for (std::size_t k = 0; k < across.size(); ++k) {
      if (k > 0 && across[k] == across[k - 1]) {
        ++graph.weights.back();
        continue;
      }
      graph.neighbours.push_back(across[k]);
      graph.weights.push_back(1);
    }
    if (graph.neighbours.size() > static_cast<std::size_t>(std::numeric_limits<SCOTCH_Num>::max()))
      throw InvalidMesh("the elements share more interfaces than Scotch can number");
    graph.offsets.push_back(static_cast<SCOTCH_Num>(graph.neighbours.size()));
  }
  return graph;
}

/// One thread: several divide a graph differently from run to run.
class ScotchGraph {
 public:
  explicit ScotchGraph(ElementGraph& graph) {
    check(SCOTCH_contextInit(&context_));
    check(SCOTCH_contextOptionSetNum(&context_, SCOTCH_OPTIONNUMDETERMINISTIC, 1));
    check(SCOTCH_contextThreadSpawn(&context_, 1, nullptr));
    const SCOTCH_Num n = static_cast<SCOTCH_Num>(graph.offsets.size()) - 1;
    check(SCOTCH_graphInit(&graph_));
    check(SCOTCH_graphBuild(&graph_, 0, n, graph.offsets.data(), nullptr, nullptr, nullptr,
                            static_cast<SCOTCH_Num>(graph.neighbours.size()),
                            graph.neighbours.data(), graph.weights.data()));
    check(SCOTCH_graphInit(&bound_));
    check(SCOTCH_contextBindGraph(&context_, &graph_, &bound_));
  }
  ~ScotchGraph() {
    SCOTCH_graphExit(&bound_);
    SCOTCH_graphExit(&graph_);
    SCOTCH_contextExit(&context_);
  }
  ScotchGraph(const ScotchGraph&) = delete;
  ScotchGraph& operator=(const ScotchGraph&) = delete;

  std::vector<SCOTCH_Num> parts(SCOTCH_Num n_parts, std::size_t n) {
    std::vector<SCOTCH_Num> parts(n);
    SCOTCH_Strat strategy;
    check(SCOTCH_stratInit(&strategy));
    constexpr double kImbalance = 0.02;
    check(SCOTCH_stratGraphMapBuild(&strategy, SCOTCH_STRATQUALITY, n_parts, kImbalance));
    SCOTCH_randomReset();
    const int failed = SCOTCH_graphPart(&bound_, n_parts, &strategy, parts.data());
    SCOTCH_stratExit(&strategy);
    check(failed);
    return parts;
  }

 private:
  static void check(int failed) {
    if (failed != 0) throw SolverFailure("Scotch could not partition the mesh");
  }
  SCOTCH_Context context_;
  SCOTCH_Graph graph_, bound_;
};

std::vector<Index> partition(ElementGraph graph, Index n_parts) {
  const std::size_t n = graph.offsets.size() - 1;
  if (n_parts < 1)
    throw InvalidOption("a mesh cannot be divided into " + std::to_string(n_parts) +
                        " parts; at least 1");
  if (n_parts == 1 || n == 0) return std::vector<Index>(n, 0);
  const std::vector<SCOTCH_Num> parts = ScotchGraph(graph).parts(n_parts, n);
  return {parts.begin(), parts.end()};
}

}  // namespace

std::vector<Index> partition(const PolygonMesh& mesh, Index n_parts) {
  const EdgeTopology& edges = mesh.edges();
  return partition(element_graph(mesh.n_faces(),
                                 [&](Index f, const auto& visit) {
                                   for (Index c = mesh.faces().begin(f); c < mesh.faces().end(f);
                                        ++c)
                                     for (const Index other : edges.corners.row(edges.of_corner[c]))
                                       visit(mesh.corner_faces()[other]);
                                 }),
                   n_parts);
}

std::vector<Index> partition(const PolyhedralMesh& mesh, Index n_parts) {
  return partition(element_graph(mesh.n_cells(),
                                 [&](Index c, const auto& visit) {
                                   for (const Index f : mesh.cell(c))
                                     if (const Index other = mesh.face_cells()[f].other(c);
                                         other >= 0)
                                       visit(other);
                                 }),
                   n_parts);
}

}  // namespace carat
