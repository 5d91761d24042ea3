// carat claims: what every operator promises, measured.

#include "carat/report/claims.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "carat/base/error.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/mesh_kinds.h"

namespace carat::cli {
namespace {

struct Options {
  std::vector<std::string> operators, families;
  ClaimOptions claims;
};

constexpr std::size_t kColumns = 36;  // of operator and family

char mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::Kept:
      return '+';
    case Verdict::Denied:
      return '-';
    case Verdict::Holds:
      return 'o';
    case Verdict::Violated:
      return 'X';
    default:
      return '.';
  }
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

bool wanted(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

/// The table being made, one line an operator and family.
class Table {
 public:
  Table(Session& session, const Options& options) : session_(session), options_(options) {
    session.report()["claims"] = Json::array();
    std::string header = padded("", kColumns);
    char letter = 'a';
    for (const Claim& claim : claims()) {
      session.say(std::string(1, letter) + "  " + padded(claim.name, 24) + claim.title);
      session.report()["claims"].push_back({{"name", claim.name}, {"title", claim.title}});
      header.append(1, ' ').append(1, letter++);
    }
    session.say("\n+ kept   - denied, as the literature says   o holds here, though not promised");
    session.say("X VIOLATED   . without meaning here\n\n" + header);
    session.report()["results"] = Json::array();
  }

  template <class Entry, class Family>
  void add(const KindWords& kind, const Entry& entry, const Family& family) {
    const std::vector<ClaimResult> results =
        session_.phase("measure", [&] { return measure_claims(entry, family, options_.claims); });
    if (results.empty()) return;
    ++rows_;
    std::string line = padded(padded(entry.name, 16) + family.name, kColumns);
    Json of_claims = Json::object();
    for (const ClaimResult& result : results) {
      line.append(1, ' ').append(1, mark(result.verdict));
      ++counts_[static_cast<std::size_t>(result.verdict)];
      if (result.verdict == Verdict::None) continue;
      of_claims[result.claim] = {{"verdict", verdict_name(result.verdict)},
                                 {"measured", result.measured},
                                 {"limit", result.limit}};
      if (result.verdict == Verdict::Violated)
        violations_.push_back(std::string(entry.name) + " on " + family.name + ": " + result.claim +
                              " is " + text(result.measured) + ", limit " + text(result.limit));
    }
    session_.say(line);
    session_.report()["results"].push_back({{"operator", entry.name},
                                            {"kind", kind.name},
                                            {"family", family.name},
                                            {"claims", of_claims}});
  }

  /// Whether no claim is violated.
  void finish() {
    if (rows_ == 0)
      throw InvalidOption("no operator of those chosen is defined on a family of those chosen");
    Json& counts = session_.report()["counts"];
    std::string line;
    for (const Verdict verdict :
         {Verdict::Kept, Verdict::Denied, Verdict::Holds, Verdict::Violated}) {
      const int n = counts_[static_cast<std::size_t>(verdict)];
      counts[verdict_name(verdict)] = n;
      line += (line.empty() ? "" : ", ") + std::to_string(n) + ' ' + verdict_name(verdict);
    }
    session_.say("\n" + line);
    for (const std::string& violation : violations_) session_.note("violated: " + violation);
    if (!violations_.empty()) session_.set_exit_code(kNumerical);
  }

 private:
  Session& session_;
  const Options& options_;
  int rows_ = 0;
  std::array<int, 5> counts_{};
  std::vector<std::string> violations_;
};

void run(Session& session, const Options& options) {
  Options settled = options;
  settled.claims.threads = session.threads();
  Table table(session, settled);
  const auto add_all = [&](const KindWords& kind, const auto& operators, const auto& families) {
    for (const auto* entry : operators)
      for (const auto& family : families)
        if (wanted(options.operators, entry->name) && wanted(options.families, family.name))
          table.add(kind, *entry, family);
  };
  add_all(kSurfaceWords, surface_operators(), mesh_families());
  add_all(kVolumeWords, volume_operators(), volume_families());
  table.finish();
}

/// Without repetition, in order.
template <class Entries, class NameOf>
void add_names(std::vector<std::string>& names, const Entries& entries, const NameOf& name_of) {
  for (const auto& entry : entries)
    if (!wanted(names, name_of(entry)) || names.empty()) names.emplace_back(name_of(entry));
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  std::vector<std::string> operators, families;
  const auto entry_name = [](const auto* entry) { return entry->name; };
  const auto family_name = [](const auto& family) { return family.name; };
  add_names(operators, surface_operators(), entry_name);
  add_names(operators, volume_operators(), entry_name);
  add_names(families, mesh_families(), family_name);
  add_names(families, volume_families(), family_name);
  app.add_option("--operator", options->operators, "Only these; see carat list operators")
      ->check(CLI::IsMember(operators))
      ->option_text("NAME ...");
  app.add_option("--family", options->families, "Only these; see carat list families")
      ->check(CLI::IsMember(families))
      ->option_text("NAME ...");
  app.add_option("--level", options->claims.level, "Of the meshes on which structure is measured")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--jitter", options->claims.jitter, "Of the same, 0 to 0.5")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command claims_command = {
    "claims",
    "Measure what every operator promises, on families of meshes",
    "Prints a table operator x family x claim. A promise that is not kept ends the program with\n"
    "exit code 4. Defects are relative to the natural size of what they are made of.",
    "  carat claims\n"
    "  carat claims --operator diamond --operator bunge --family cube-voronoi\n"
    "  carat claims --family plane-quads --jitter 0 --json\n",
    false,
    declare};

}  // namespace carat::cli
