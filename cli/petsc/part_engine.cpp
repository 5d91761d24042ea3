#include "cli/petsc/part_engine.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "carat/distributed/eigenmodes.h"
#include "carat/distributed/heat_geodesics.h"
#include "carat/distributed/message.h"
#include "carat/distributed/partition.h"
#include "carat/distributed/poisson.h"
#include "carat/distributed/processes.h"
#include "cli/expression.h"
#include "cli/failure.h"

namespace carat::cli {
namespace {

enum class Job : int { GoHome, Poisson, Geodesics, Eigenmodes };

void put(Message& message, const std::string& text) { message.put_list(text); }

void put(Message& message, const Matrix& matrix) {
  message.put(matrix.rows());
  message.put(matrix.cols());
  message.put_list(std::vector<double>(matrix.data(), matrix.data() + matrix.size()));
}

void take(Message& message, Matrix& matrix) {
  Eigen::Index rows = 0, columns = 0;
  std::vector<double> values;
  message.take(rows);
  message.take(columns);
  message.take_list(values);
  matrix = Eigen::Map<const Matrix>(values.data(), rows, columns);
}

/// Place of a number in an ascending list; -1: not there.
Index find(const Array<Index>& list, Index number) {
  const auto at = std::lower_bound(list.begin(), list.end(), number);
  return at != list.end() && *at == number ? static_cast<Index>(at - list.begin()) : -1;
}

/// What the part gets of data that lie at some vertices or sides of the whole mesh.
void put_at(Message& message, const Array<Index>& held, const std::vector<Index>& places,
            std::initializer_list<const std::vector<double>*> values) {
  std::vector<Index> here;
  std::vector<std::vector<double>> own(values.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Index place = find(held, places[k]);
    if (place < 0) continue;
    here.push_back(place);
    std::size_t i = 0;
    for (const std::vector<double>* list : values) own[i++].push_back((*list)[k]);
  }
  message.put_list(here);
  for (const std::vector<double>& list : own) message.put_list(list);
}

void put_operator(Message& message, const EngineProblem& problem, const PartNumbers& numbers) {
  const DiscretizationOptions& options = problem.options;
  put(message, problem.operator_name);
  put(message, problem.coefficient);
  message.put(options.virtual_vertex);
  message.put(options.mass);
  message.put(options.lambda);
  message.put(options.theta);
  message.put(options.tau);
  message.put(options.degenerate);
  message.put(options.parts);
  const Matrix& k = options.cell_coefficient;
  Matrix own(k.rows() > 0 ? static_cast<Index>(numbers.elements.size()) : 0, k.cols());
  for (Index e = 0; e < own.rows(); ++e) own.row(e) = k.row(numbers.elements[e]);
  put(message, own);
}

/// A part with the operators that it brings.
template <class Mesh>
struct PartOperators {
  MeshPart<Mesh> part;
  Discretization discretization;

  explicit PartOperators(Message& message) {
    together([&] {
      take(message, part);
      std::string name, coefficient;
      DiscretizationOptions options;
      message.take_list(name);
      message.take_list(coefficient);
      message.take(options.virtual_vertex);
      message.take(options.mass);
      message.take(options.lambda);
      message.take(options.theta);
      message.take(options.tau);
      message.take(options.degenerate);
      message.take(options.parts);
      take(message, options.cell_coefficient);
      options.threads = 1;
      if (!coefficient.empty()) options.coefficient = Expression("--coefficient", coefficient);
      discretization = discretize_part(part, name, options);
    });
  }
};

/// Own rows of columns of values at the part's vertices, with the vertices' numbers.
void put_own(Message& message, const PartNumbers& numbers, const Matrix& values) {
  std::vector<Index> vertices;
  Matrix own(numbers.end_row - numbers.first_row, values.cols());
  for (Index v = 0; v < values.rows(); ++v)
    if (numbers.own_vertex(v)) {
      own.row(static_cast<Index>(vertices.size())) = values.row(v);
      vertices.push_back(numbers.vertices[v]);
    }
  message.put_list(vertices);
  put(message, own);
}

/// What the first process makes of the own rows of all.
void take_own(Message& message, Matrix& whole) {
  std::vector<Index> vertices;
  Matrix own;
  message.take_list(vertices);
  take(message, own);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    whole.row(vertices[k]) = own.row(static_cast<Index>(k));
}

/// The results of a job: values are returned by all, the rest is that of any process.
struct Answer {
  Message values;
  PoissonSolution poisson;
  GeodesicDistance distance;
  EigenPairs pairs;
  double time_step = 0;
};

template <class Mesh>
Answer work(Job job, Message& message) {
  const PartOperators<Mesh> own(message);
  const PartNumbers& numbers = own.part.numbers;
  Answer answer;
  if (job == Job::Poisson) {
    BoundaryConditions conditions;
    Matrix f;
    message.take_list(conditions.dirichlet_vertices);
    message.take_list(conditions.dirichlet_values);
    message.take_list(conditions.neumann_sides);
    message.take_list(conditions.neumann_flux);
    message.take_list(conditions.robin_sides);
    message.take_list(conditions.robin_alpha);
    message.take_list(conditions.robin_g);
    take(message, f);
    answer.poisson = DistributedPoisson(own.part, own.discretization, conditions).solve(f.col(0));
    put_own(answer.values, numbers, answer.poisson.values);
  } else if (job == Job::Geodesics) {
    HeatGeodesicsOptions options;
    std::vector<GeodesicSource> sources;
    message.take(options.t_coef);
    message.take_list(sources);
    const DistributedGeodesics geodesics(own.part, own.discretization, options);
    answer.time_step = geodesics.time_step();
    answer.distance = geodesics.distance(sources);
    put_own(answer.values, numbers, answer.distance.values);
  } else {
    Index count = 0;
    std::vector<Index> fixed;
    message.take(count);
    message.take_list(fixed);
    answer.pairs = distributed_eigenmodes(own.part, own.discretization, count, fixed);
    put_own(answer.values, numbers, answer.pairs.vectors);
  }
  return answer;
}

/// Takes a job from its message and does this process's part of it.
Answer work(Message& message) {
  Job job{};
  bool volume = false;
  message.take(job);
  message.take(volume);
  return volume ? work<PolyhedralMesh>(job, message) : work<PolygonMesh>(job, message);
}

int report(const std::exception& error) { return report_failure(describe_failure(error), false); }

/// Hands a job to all processes, works on it as well, and collects the values at all vertices.
/// \param put_data  what belongs to the job, of a part
Answer solve(Job job, const EngineProblem& problem, int n_processes, Matrix& values,
             const std::function<void(Message&, const PartNumbers&)>& put_data) {
  const auto run = [&](const auto* mesh) {
    const MeshDivision division = divide(*mesh, n_processes, partition(*mesh, n_processes));
    Message own;
    for (int process = n_processes; process-- > 0;) {
      const auto part = part_of(*mesh, division, process);
      Message message;
      message.put(job);
      message.put(problem.mesh.index() == 1);
      put(message, part);
      put_operator(message, problem, part.numbers);
      put_data(message, part.numbers);
      if (process > 0)
        message.send(process);
      else
        own = std::move(message);
    }
    Answer answer = work(own);
    take_own(answer.values, values);
    for (int process = 1; process < n_processes; ++process) {
      Message message = Message::receive(process);
      take_own(message, values);
    }
    return answer;
  };
  try {
    return std::visit(run, problem.mesh);
  } catch (const std::exception& error) {
    if (dynamic_cast<const SharedFailure*>(&error) == nullptr && n_processes > 1)
      end_job(report(error));
    throw;
  }
}

Index n_vertices(const EngineProblem& problem) {
  return std::visit([](const auto* mesh) { return mesh->n_vertices(); }, problem.mesh);
}

}  // namespace

PartEngine::~PartEngine() {
  for (int process = 1; process < n_processes_; ++process) {
    Message message;
    message.put(Job::GoHome);
    message.send(process);
  }
}

PoissonSolution PartEngine::poisson(const EngineProblem& problem,
                                    const BoundaryConditions& conditions, const Vector& f) {
  Matrix values(n_vertices(problem), 1);
  Answer answer = solve(Job::Poisson, problem, n_processes_, values,
                        [&](Message& message, const PartNumbers& numbers) {
                          put_at(message, numbers.vertices, conditions.dirichlet_vertices,
                                 {&conditions.dirichlet_values});
                          put_at(message, numbers.interfaces, conditions.neumann_sides,
                                 {&conditions.neumann_flux});
                          put_at(message, numbers.interfaces, conditions.robin_sides,
                                 {&conditions.robin_alpha, &conditions.robin_g});
                          Matrix own(static_cast<Index>(numbers.vertices.size()), 1);
                          for (Index v = 0; v < own.rows(); ++v) own(v, 0) = f[numbers.vertices[v]];
                          put(message, own);
                        });
  answer.poisson.values = values.col(0);
  return answer.poisson;
}

GeodesicDistance PartEngine::geodesics(const EngineProblem& problem, double t_coef,
                                       const std::vector<GeodesicSource>& sources,
                                       double& time_step) {
  Matrix values(n_vertices(problem), 1);
  Answer answer = solve(Job::Geodesics, problem, n_processes_, values,
                        [&](Message& message, const PartNumbers&) {
                          message.put(t_coef);
                          message.put_list(sources);
                        });
  time_step = answer.time_step;
  answer.distance.values = values.col(0);
  answer.distance.unreachable_vertices.clear();
  for (Index v = 0; v < values.rows(); ++v)
    if (values(v, 0) == std::numeric_limits<double>::infinity())
      answer.distance.unreachable_vertices.push_back(v);
  return answer.distance;
}

EigenPairs PartEngine::eigenmodes(const EngineProblem& problem, Index count,
                                  const std::vector<Index>& fixed) {
  Matrix values(n_vertices(problem), std::max(count, 0));
  Answer answer = solve(Job::Eigenmodes, problem, n_processes_, values,
                        [&](Message& message, const PartNumbers& numbers) {
                          message.put(count);
                          put_at(message, numbers.vertices, fixed, {});
                        });
  answer.pairs.vectors = values;
  return answer.pairs;
}

void work_on_parts() {
  for (;;) {
    Message message = Message::receive(0);
    Message copy = message;
    Job job{};
    copy.take(job);
    if (job == Job::GoHome) return;
    try {
      work(message).values.send(0);
    } catch (const std::exception& error) {
      // What all know the first process tells.
      if (dynamic_cast<const SharedFailure*>(&error) == nullptr) end_job(report(error));
    }
  }
}

}  // namespace carat::cli
