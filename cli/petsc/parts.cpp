#include "cli/petsc/parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "carat/base/error.h"
#include "carat/base/memory.h"
#include "carat/distributed/number_exchange.h"
#include "carat/distributed/part_fields.h"
#include "carat/distributed/part_samples.h"
#include "carat/distributed/partition.h"
#include "carat/distributed/poisson.h"
#include "carat/distributed/read_parts.h"
#include "carat/distributed/scatter.h"
#include "carat/distributed/write_parts.h"
#include "carat/operators/part_discretization.h"

namespace carat::cli {
namespace {

/// Whether something holds in the first process.
bool in_first(const std::function<bool()>& holds) {
  std::int64_t answer = 0;
  on_first([&] { answer = holds() ? 1 : 0; });
  return sum_of_all(answer) > 0;
}

PartInput read_and_divide(Session& session, const std::string& path, bool keeps_whole) {
  PartInput input;
  on_first([&] {
    input.whole =
        std::make_unique<MeshData>(session.phase("read", [&] { return read_mesh(path); }));
  });
  std::vector<Index> element_part;
  session.phase("divide", [&] {
    on_first([&] {
      element_part = std::visit(
          [](const auto& held) { return partition(held.mesh, n_processes()); }, *input.whole);
    });
    input.data = scatter(input.whole.get(), element_part);
  });
  if (!keeps_whole) input.whole.reset();
  return input;
}

MeshSizes whole_sizes(const MeshPart<PolygonMesh>& part) {
  const PartNumbers& numbers = part.numbers;
  MeshSizes sizes;
  std::vector<std::int64_t> counts(3, 0);
  for (const bool own : numbers.own_interfaces) counts[0] += own;
  for (Index f = 0; f < part.mesh.n_faces(); ++f) {
    if (!numbers.own_elements[static_cast<std::size_t>(f)]) continue;
    ++counts[1];
    counts[2] += part.mesh.faces().size(f);
  }
  counts = sum_of_all(std::move(counts));
  sizes.vertices = numbers.n_vertices;
  sizes.edges = counts[0];
  sizes.faces = counts[1];
  sizes.corners = counts[2];
  return sizes;
}

MeshSizes whole_sizes(const MeshPart<PolyhedralMesh>& part) {
  const PartNumbers& numbers = part.numbers;
  MeshSizes sizes;
  std::vector<std::int64_t> counts(3, 0);
  for (Index f = 0; f < part.mesh.n_faces(); ++f) {
    if (!numbers.own_interfaces[static_cast<std::size_t>(f)]) continue;
    ++counts[0];
    counts[1] += part.mesh.face_mesh().faces().size(f);
  }
  for (const bool own : numbers.own_elements) counts[2] += own;
  counts = sum_of_all(std::move(counts));
  sizes.vertices = numbers.n_vertices;
  sizes.edges = edge_lengths(part).count;
  sizes.faces = counts[0];
  sizes.corners = counts[1];
  sizes.cells = counts[2];
  return sizes;
}

/// An error of one element with its number in the whole mesh.
InvalidOption in_whole_numbers(const InvalidOption& error, const Array<Index>& elements) {
  if (error.elements().size() != 1) return error;
  const Index here = error.elements()[0], whole = elements[here];
  std::string message = error.what();
  const std::string number = std::to_string(here);
  if (const std::size_t at = message.find(number); at != message.npos)
    message.replace(at, number.size(), std::to_string(whole));
  return InvalidOption(message, {whole});
}

/// Fields of the whole mesh in the first process.
template <class Gather>
std::vector<Field> gather_fields(const std::vector<Field>& fields, const Gather& gather) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Field> gathered;
  for (const Field& field : fields) {
    const Rows whole =
        gather(Eigen::Map<const Rows>(field.values.data(), field.n_rows(), field.components));
    gathered.push_back({field.name, field.components, {whole.data(), whole.data() + whole.size()}});
  }
  return gathered;
}

Json largest_and_sum(std::int64_t value) {
  return {{"largest", static_cast<std::int64_t>(largest_of_all(static_cast<double>(value)))},
          {"sum", sum_of_all(value)}};
}

void report_sizes(Session& session, const PartNumbers& numbers) {
  const auto n_elements = static_cast<std::int64_t>(numbers.elements.size());
  const std::int64_t own =
      std::count(numbers.own_elements.begin(), numbers.own_elements.end(), true);
  const std::int64_t others =
      static_cast<std::int64_t>(numbers.vertices.size()) - (numbers.end_row - numbers.first_row);
  Json& report = session.report()["parts"];
  report["own_elements"] = largest_and_sum(own);
  report["halo_elements"] = largest_and_sum(n_elements - own);
  report["vertices_of_others"] = largest_and_sum(others);
}

}  // namespace

void check_part_output(const std::string& path) {
  if (is_parallel_index(path))
    check_output_folder(path);
  else
    check_output(path, Content::MeshFields);
}

PartInput read_part_input(Session& session, const std::string& path, const std::string& output) {
  session.report()["input"] = path;
  session.report()["processes"] = n_processes();
  const bool single = !output.empty() && !is_parallel_index(output);
  PartInput input;
  if (in_first([&] { return is_in_parts(path); })) {
    together([&] {
      if (single)
        throw InvalidOption(output + ": " + path +
                            " comes in parts, of which no process holds the whole mesh; write "
                            "parts too, -o " +
                            std::filesystem::path(output).replace_extension(".pvtu").string() +
                            ", and join them: carat convert");
    });
    input.data = session.phase("read", [&] { return read_parts(path); });
  } else {
    input = read_and_divide(session, path, single);
  }
  std::visit(
      [&](const auto& data) {
        const KindWords& kind = words(data.part.mesh);
        const MeshSizes sizes = whole_sizes(data.part);
        input.n_elements = static_cast<Index>(sizes.cells < 0 ? sizes.faces : sizes.cells);
        session.report()["kind"] = kind.name;
        session.report()["sizes"] = sizes_to_json(sizes);
        session.say(path + ": " + describe_sizes(sizes));
        together([&] {
          if (single) check_output_kind(output, kind);
        });
      },
      input.data);
  return input;
}

template <class Mesh>
Discretization discretize(Session& session, const MeshPart<Mesh>& part,
                          const OperatorOptions& options, DiscretizationParts parts,
                          const Coefficient& coefficient, MatrixNeed need) {
  return session.phase("assemble", [&] {
    Discretization discretization;
    ChosenOperator chosen;
    bool strict = false;
    together([&] { chosen = choose_operator(session, part.mesh, options); });
    if (need == MatrixNeed::Multiplied)
      chosen.options.form = distributed_poisson_form(part, chosen.name);
    together([&] {
      chosen.options.parts = parts;
      chosen.options.coefficient = coefficient.function;
      chosen.options.cell_coefficient = coefficient.of_cells;
      chosen.options.threads = 1;
      // Only all together know which samples of the whole mesh these are.
      strict = chosen.options.degenerate == DegeneratePolicy::Strict;
      chosen.options.degenerate = DegeneratePolicy::Report;
      try {
        discretization = discretize_part(part, chosen.name, chosen.options);
      } catch (const InvalidOption& error) {
        throw in_whole_numbers(error, part.numbers.elements);
      }
    });
    session.say("operator " + discretization.name + ": " + count(part.numbers.n_vertices, "row") +
                ", " +
                (n_processes() == 1 ? "1 process" : std::to_string(n_processes()) + " processes"));
    for (const WholeFinding& finding : whole_diagnostics(part, discretization, strict))
      session.add_finding(finding.name, finding.meaning, finding.elements);
    report_sizes(session, part.numbers);
    if (need == MatrixNeed::Entries)
      report_share(session, share_of(discretization.stiffness, part.numbers));
    return discretization;
  });
}

void report_share(Session& session, const PartShare& share) {
  Json& report = session.report()["parts"];
  report["matrix_entries"] = largest_and_sum(share.entries);
  report["matrix_bytes_sent"] = largest_and_sum(share.bytes_sent());
}

void report_memory(Session& session) {
  session.report()["parts"]["peak_memory"] =
      largest_and_sum(static_cast<std::int64_t>(peak_memory()));
}

template <class Mesh>
void write_part_output(Session& session, const std::string& path, const std::string& title,
                       PartInput& input, const MeshPart<Mesh>& part, MeshFields fields) {
  if (path.empty()) return;
  if (is_parallel_index(path)) {
    session.phase("write", [&] { write_parts(path, part, fields); });
    session.report()["output"] = path;
    session.say("written: " + path);
    return;
  }
  std::vector<Field>& of_elements = element_fields(fields, part.mesh);
  fields.vertex = gather_fields(
      fields.vertex, [&](const Matrix& values) { return gather_vertices(part.numbers, values); });
  of_elements = gather_fields(of_elements, [&](const Matrix& values) {
    return gather_elements(part.numbers, values, input.n_elements);
  });
  on_first([&] {
    std::visit([&](auto& held) { held.fields = std::move(fields); }, *input.whole);
    write_output(session, path, title, *input.whole);
  });
}

Extremes part_extremes(const PartNumbers& numbers, const Vector& values) {
  constexpr double kNothing = -std::numeric_limits<double>::infinity();
  const auto largest = [&](double sign, double& value, std::int64_t& vertex) {
    double here = kNothing;
    for (Index v = 0; v < values.size(); ++v)
      if (numbers.own_vertex(v) && std::isfinite(values[v]))
        here = std::max(here, sign * values[v]);
    const double of_all = largest_of_all(here);
    if (of_all == kNothing) return;
    double lowest = kNothing;
    for (Index v = 0; v < values.size(); ++v)
      if (numbers.own_vertex(v) && sign * values[v] == of_all)
        lowest = std::max(lowest, -static_cast<double>(numbers.vertices[v]));
    value = sign * of_all;
    vertex = static_cast<std::int64_t>(-largest_of_all(lowest));
  };
  Extremes extremes;
  largest(-1, extremes.least, extremes.least_vertex);
  largest(1, extremes.largest, extremes.largest_vertex);
  return extremes;
}

std::vector<Index> boundary_sides(const MeshPart<PolygonMesh>& part) {
  std::vector<Index> sides = boundary_sides(part.mesh);
  std::erase_if(sides, [&](Index side) { return !part.numbers.own_interfaces[side]; });
  return sides;
}

std::vector<Index> boundary_sides(const MeshPart<PolyhedralMesh>& part) {
  std::vector<Index> sides = boundary_sides(part.mesh);
  std::erase_if(sides, [&](Index side) { return !part.numbers.own_interfaces[side]; });
  return sides;
}

std::vector<std::int64_t> SharedBoundary::sum(std::vector<std::int64_t> counts) const {
  return sum_of_all(std::move(counts));
}

void SharedBoundary::take_lowest(std::vector<int>& entry_of_vertex) const {
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  std::vector<std::int64_t> entries;
  entries.reserve(entry_of_vertex.size());
  for (const int entry : entry_of_vertex) entries.push_back(entry < 0 ? kNone : entry);
  entries = NumberExchange(numbers_.vertices).least(entries);
  for (std::size_t v = 0; v < entries.size(); ++v)
    entry_of_vertex[v] = entries[v] == kNone ? -1 : static_cast<int>(entries[v]);
}

template Discretization discretize(Session&, const MeshPart<PolygonMesh>&, const OperatorOptions&,
                                   DiscretizationParts, const Coefficient&, MatrixNeed);
template Discretization discretize(Session&, const MeshPart<PolyhedralMesh>&,
                                   const OperatorOptions&, DiscretizationParts, const Coefficient&,
                                   MatrixNeed);
template void write_part_output(Session&, const std::string&, const std::string&, PartInput&,
                                const MeshPart<PolygonMesh>&, MeshFields);
template void write_part_output(Session&, const std::string&, const std::string&, PartInput&,
                                const MeshPart<PolyhedralMesh>&, MeshFields);

}  // namespace carat::cli
