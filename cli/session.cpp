#include "cli/session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string_view>

#include "carat/base/error.h"
#include "carat/base/memory.h"
#include "carat/base/parallel.h"

namespace carat::cli {
namespace {

void flush_output() {
  if (!std::cout.flush()) throw IoError("standard output cannot be written; is the disk full?");
}

}  // namespace

Session::Session(const std::string& command, const CommonOptions& options) : options_(options) {
  report_["command"] = command;
  report_["version"] = CARAT_VERSION;
  report_["threads"] = resolve_threads(options.threads);
}

void Session::say(const std::string& line) {
  if (!options_.json) std::cout << line << '\n';
}

void Session::note(const std::string& message) {
  notes_.push_back(message);
  std::cerr << "carat: note: " << message << '\n';
}

void Session::add_diagnostics(const Diagnostics& diagnostics) {
  for (const Finding& finding : diagnostics.findings())
    add_finding(finding.name, finding.meaning, {finding.elements.begin(), finding.elements.end()});
}

void Session::add_finding(const std::string& name, const std::string& meaning,
                          const std::vector<std::int64_t>& elements) {
  // What the mesh and an operator both find is news once.
  const bool known = diagnostics_.contains(name);
  diagnostics_[name] = {
      {"count", elements.size()}, {"elements", first_elements(elements)}, {"meaning", meaning}};
  if (known || elements.empty()) return;
  std::string line =
      "! " + describe_count(static_cast<std::int64_t>(elements.size()), meaning) + " (";
  for (std::size_t i = 0; i < elements.size() && i < 5; ++i)
    line += (i > 0 ? ", " : "") + std::to_string(elements[i]);
  say(line + (elements.size() > 5 ? ", ...)" : ")"));
}

Session::Phase::Phase(Session& owner, const char* phase)
    : session(owner), name(phase), start(std::chrono::steady_clock::now()), line(phase) {}

Session::Phase::~Phase() {
  session.cost_of(name).seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Session::PhaseCost& Session::cost_of(const std::string& phase) {
  const auto known = std::find_if(costs_.begin(), costs_.end(),
                                  [&](const PhaseCost& cost) { return cost.name == phase; });
  return known != costs_.end() ? *known : costs_.emplace_back(PhaseCost{phase});
}

void Session::moved(const char* phase, double bytes) { cost_of(phase).bytes += bytes; }

Json Session::snapshot() const {
  Json object = report_;
  object["seconds"] = Json::object();
  object["profile"] = Json::object();
  for (const PhaseCost& cost : costs_) {
    object["seconds"][cost.name] = cost.seconds;
    const bool known = cost.bytes > 0 && cost.seconds > 0;
    object["profile"][cost.name] = {
        {"seconds", cost.seconds},
        {"bytes", known ? Json(cost.bytes) : Json(nullptr)},
        {"GB_per_s", known ? Json(1e-9 * cost.bytes / cost.seconds) : Json(nullptr)}};
  }
  object["peak_memory"] = peak_memory();
  if (!notes_.empty()) object["notes"] = notes_;
  object["diagnostics"] = diagnostics_;
  return object;
}

void Session::finish() {
  if (options_.json) {
    print_json(snapshot());
    return;
  }
  std::string line;
  for (const PhaseCost& cost : costs_) {
    char entry[32];
    std::snprintf(entry, sizeof entry, " %.3g s", cost.seconds);
    line += (line.empty() ? "time: " : ", ") + cost.name + entry;
  }
  if (!line.empty()) say(line);
  flush_output();
}

void print_json(const Json& object) {
  std::cout << object.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  flush_output();
}

std::string text(double value) {
  if (std::isnan(value)) return "nan";  // printf would give it a sign
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string count(std::int64_t n, const std::string& noun) {
  if (n == 1) return "1 " + noun;
  if (noun.ends_with("vertex"))
    return std::to_string(n) + " " + noun.substr(0, noun.size() - 2) + "ices";
  return std::to_string(n) + " " + noun + "s";
}

std::string describe_count(std::int64_t n, std::string what) {
  constexpr std::pair<std::string_view, std::string_view> forms[] = {
      {"vertices", "vertex"},    {"edges", "edge"},
      {"faces", "face"},         {"cells", "cell"},
      {"samples", "sample"},     {"diamonds", "diamond"},
      {"triangles", "triangle"}, {"tetrahedra", "tetrahedron"}};
  if (n == 1) {
    const auto noun = std::min_element(
        std::begin(forms), std::end(forms),
        [&](const auto& a, const auto& b) { return what.find(a.first) < what.find(b.first); });
    if (const std::size_t at = what.find(noun->first); at != std::string::npos)
      what.replace(at, noun->first.size(), noun->second);
  }
  return std::to_string(n) + " " + what;
}

Json first_elements(const std::vector<std::int64_t>& elements) {
  Json list = Json::array();
  for (std::size_t i = 0; i < elements.size() && i < 100; ++i) list.push_back(elements[i]);
  return list;
}

}  // namespace carat::cli
