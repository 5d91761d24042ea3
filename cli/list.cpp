// carat list: what the program knows.

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <type_traits>

#include "carat/apps/recommended.h"
#include "carat/generators/families.h"
#include "carat/io/mesh_file.h"
#include "carat/operators/registry.h"
#include "cli/command.h"
#include "cli/experiments/experiment.h"
#include "cli/mesh_kinds.h"

namespace carat::cli {
namespace {

/// One line of a list: a name in a column and what it is.
void say_entry(Session& session, std::string name, const std::string& title) {
  name.resize(std::max<std::size_t>(name.size() + 1, 22), ' ');
  session.say(name + title);
}

/// The entries of one kind of meshes under its name.
template <class Entries, class Describe>
void list_kind(Session& session, const KindWords& kind, const Entries& entries, Json& list,
               const Describe& describe) {
  std::string heading = kind.plural;
  heading[0] = static_cast<char>(heading[0] - 'a' + 'A');
  session.say(heading);
  for (const auto& entry : entries) list.push_back(describe(entry, kind));
}

Json describe_options(const OperatorOptionSet& options) {
  Json json;
  for (const MassKind kind : options.masses) json["mass"].push_back(mass_kind_name(kind));
  json["virtual_vertex"] = options.virtual_vertex;
  if (options.lambda) json["lambda"] = *options.lambda;
  if (options.theta) json["theta"] = *options.theta;
  if (options.tau) json["tau"] = *options.tau;
  if (options.boundary_unknowns) json["boundary_unknowns"] = *options.boundary_unknowns;
  return json;
}

template <class Entry>
Json describe_operator(const Entry& entry, const char* kind, const Json& default_of) {
  const OperatorClaims& claims = entry.claims;
  return {{"name", entry.name},
          {"kind", kind},
          {"title", entry.title},
          {"citation", entry.citation},
          {"default_of", default_of},
          {"claims",
           {{"symmetric", claims.symmetric},
            {"semidefinite", claims.semidefinite},
            {"kernel_is_constants", claims.kernel_is_constants},
            {"linear_precision", claims.linear_precision},
            {"gradient", claims.gradient},
            {"divergence_of_gradient", claims.divergence_of_gradient},
            {"total_mass", claims.total_mass},
            {"positive_mass", claims.positive_mass},
            {"maximum_principle", claims.maximum_principle},
            {"second_order", claims.second_order},
            {"equals_cotan_on_simplices", claims.equals_cotan_on_simplices},
            {"simplices_only", claims.simplices_only},
            {"face_local", claims.face_local},
            {"vertex_unknowns", claims.vertex_unknowns}}},
          {"options", describe_options(entry.options)},
          {"card",
           {{"definition", entry.card.definition},
            {"unknowns", entry.card.unknowns},
            {"sparsity", entry.card.sparsity},
            {"when", entry.card.when},
            {"references", entry.card.references}}}};
}

/// The commands that take the operator where none is named, with the options that they give it.
template <class Mesh>
Json uses_by_default(const OperatorEntry<Mesh>& entry, const Mesh& mesh) {
  constexpr std::array<std::pair<const char*, Application>, 4> kApplications{
      {{"curvature", Application::MeanCurvature},
       {"geodesics", Application::Geodesics},
       {"poisson", Application::Poisson},
       {"eigen", Application::Eigenmodes}}};
  Json uses = Json::array();
  if (&entry == operators_of(mesh).front()) uses.push_back({{"command", "operators"}});
  for (const auto& [command, application] : kApplications) {
    const OperatorChoice choice = recommended_operator(application, mesh);
    if (std::is_same_v<Mesh, PolyhedralMesh> && application == Application::MeanCurvature) continue;
    if (std::string(choice.name) != entry.name) continue;
    Json use{{"command", command}};
    if (choice.mass != MassKind::Default) use["mass"] = mass_kind_name(choice.mass);
    if (choice.theta) use["theta"] = *choice.theta;
    uses.push_back(use);
  }
  return uses;
}

Json list_operators(Session& session) {
  Json list = Json::array();
  const auto list_all = [&](const KindWords& kind, const auto& operators, const auto& mesh) {
    list_kind(session, kind, operators, list,
              [&](const auto* entry, const KindWords& words) -> Json {
                say_entry(session, std::string("  ") + entry->name,
                          std::string(entry->title) + " [" + entry->citation + "]");
                return describe_operator(*entry, words.name, uses_by_default(*entry, mesh));
              });
  };
  list_all(kSurfaceWords, surface_operators(), PolygonMesh());
  list_all(kVolumeWords, volume_operators(), PolyhedralMesh());
  return list;
}

Json list_families(Session& session) {
  Json list = Json::array();
  const auto describe = [&](const auto& entry, const KindWords& words) -> Json {
    say_entry(session, std::string("  ") + entry.name,
              std::string(entry.title) + " (" + entry.domain + ")");
    return {{"name", entry.name},
            {"kind", words.name},
            {"title", entry.title},
            {"domain", entry.domain}};
  };
  list_kind(session, kSurfaceWords, mesh_families(), list, describe);
  list_kind(session, kVolumeWords, volume_families(), list, describe);
  return list;
}

/// "; reads surfaces and volumes", or nothing.
std::string ability(const std::string& verb, bool surfaces, bool volumes) {
  if (!surfaces && !volumes) return "";
  return "; " + verb + (surfaces ? " surfaces" : "") + (surfaces && volumes ? " and" : "") +
         (volumes ? " volumes" : "");
}

Json list_formats(Session& session) {
  Json list = Json::array();
  for (const FileFormat& format : file_formats()) {
    std::string line = format.title;
    for (const std::string& extension : format.extensions) line += " " + extension;
    line += ability("reads", format.reads, format.reads_volumes);
    line += ability("writes", format.writes, format.writes_volumes);
    if (format.fields) line += "; with fields";
    say_entry(session, format.name, line);
    list.push_back({{"name", format.name},
                    {"title", format.title},
                    {"extensions", format.extensions},
                    {"reads", format.reads},
                    {"writes", format.writes},
                    {"reads_volumes", format.reads_volumes},
                    {"writes_volumes", format.writes_volumes},
                    {"fields", format.fields},
                    {"writes_patches", format.writes_patches}});
  }
  return list;
}

Json list_experiments(Session& session) {
  Json list = Json::array();
  for (const Experiment* experiment : experiments()) {
    const std::string paper = experiment->paper != nullptr ? experiment->paper : "";
    say_entry(session, experiment->name,
              std::string(experiment->title) + (paper.empty() ? "" : " (") + paper +
                  (paper.empty() ? "" : ")"));
    list.push_back({{"name", experiment->name},
                    {"title", experiment->title},
                    {"paper", paper.empty() ? Json(nullptr) : Json(paper)},
                    {"text", experiment->text}});
  }
  return list;
}

Json list_apps(Session& session) {
  Json list = Json::array();
  for (const Command* command : commands()) {
    if (!command->is_app) continue;
    say_entry(session, command->name, command->title);
    list.push_back({{"name", command->name}, {"title", command->title}});
  }
  return list;
}

struct List {
  const char* name;
  Json (*make)(Session&);
};

constexpr List kLists[] = {{"operators", list_operators},
                           {"families", list_families},
                           {"formats", list_formats},
                           {"apps", list_apps},
                           {"experiments", list_experiments}};

std::function<void(Session&)> declare(CLI::App& app) {
  const auto what = std::make_shared<std::string>();
  std::vector<std::string> names;
  for (const List& list : kLists) names.emplace_back(list.name);
  app.add_option("WHAT", *what, "What to list")->required()->check(CLI::IsMember(names));
  return [what](Session& session) {
    for (const List& list : kLists)
      if (*what == list.name) session.report()[list.name] = list.make(session);
  };
}

}  // namespace

const Command list_command = {
    "list",
    "List operators, mesh families, file formats, apps or experiments",
    "Prints the names that other commands take, with one line about each.",
    "  carat list operators\n"
    "  carat list families --json\n",
    false,
    declare};

}  // namespace carat::cli
