// carat list: what the program knows.

#include <CLI/CLI.hpp>
#include <memory>

#include "carat/generators/families.h"
#include "carat/io/mesh_file.h"
#include "carat/operators/registry.h"
#include "cli/command.h"

namespace carat::cli {
namespace {

/// One line of a list: a name in a column and what it is.
void say_entry(Session& session, std::string name, const std::string& title) {
  name.resize(std::max<std::size_t>(name.size() + 1, 18), ' ');
  session.say(name + title);
}

Json list_operators(Session& session) {
  Json list = Json::array();
  for (const SurfaceOperator* entry : surface_operators()) {
    const OperatorClaims& claims = entry->claims;
    say_entry(session, entry->name, std::string(entry->title) + " [" + entry->citation + "]");
    list.push_back({{"name", entry->name},
                    {"title", entry->title},
                    {"citation", entry->citation},
                    {"default", entry == surface_operators().front()},
                    {"claims",
                     {{"symmetric", claims.symmetric},
                      {"semidefinite", claims.semidefinite},
                      {"kernel_is_constants", claims.kernel_is_constants},
                      {"linear_precision", claims.linear_precision},
                      {"equals_cotan_on_simplices", claims.equals_cotan_on_simplices},
                      {"simplices_only", claims.simplices_only},
                      {"face_local", claims.face_local}}}});
  }
  return list;
}

Json list_families(Session& session) {
  Json list = Json::array();
  for (const FamilyEntry& entry : mesh_families()) {
    say_entry(session, entry.name, std::string(entry.title) + " (" + entry.domain + ")");
    list.push_back({{"name", entry.name}, {"title", entry.title}, {"domain", entry.domain}});
  }
  return list;
}

Json list_formats(Session& session) {
  Json list = Json::array();
  for (const FileFormat& format : file_formats()) {
    std::string line = format.title + ":";
    for (const std::string& extension : format.extensions) line += " " + extension;
    if (format.reads) line += ", reads";
    if (format.writes) line += ", writes";
    if (format.fields) line += ", with fields";
    say_entry(session, format.name, line);
    list.push_back({{"name", format.name},
                    {"title", format.title},
                    {"extensions", format.extensions},
                    {"reads", format.reads},
                    {"writes", format.writes},
                    {"fields", format.fields}});
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
                           {"apps", list_apps}};

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
    "List operators, mesh families, file formats or apps",
    "Prints the names that other commands take, with one line about each.",
    "  carat list operators\n"
    "  carat list families --json\n",
    false,
    declare};

}  // namespace carat::cli
