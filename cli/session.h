#pragma once
// One run of a command: what it reports, and how long its phases take.

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "carat/base/diagnostics.h"
#include "carat/base/types.h"
#include "cli/progress_line.h"

namespace carat::cli {

using Json = nlohmann::ordered_json;

class Engine;

/// What every command understands.
struct CommonOptions {
  bool json = false;
  int threads = 0;                 ///< 0: all the machine has
  const Engine* engine = nullptr;  ///< what solves over several processes, if that was asked for
};

/// Collects the JSON object of a run, or prints lines for people as they come. Numbers that are
/// not finite become null in JSON.
class Session {
 public:
  Session(const std::string& command, const CommonOptions& options);

  int threads() const { return options_.threads; }
  const Engine* engine() const { return options_.engine; }
  /// The JSON object. Filled in both modes; printed by finish() in one.
  Json& report() { return report_; }
  /// A line on standard output, unless JSON is asked for.
  void say(const std::string& line);
  /// A message on standard error, also listed under "notes".
  void note(const std::string& message);
  /// Findings: all of them in JSON, those that found something as lines.
  void add_diagnostics(const Diagnostics& diagnostics);
  void add_finding(const std::string& name, const std::string& meaning,
                   const std::vector<std::int64_t>& elements);

  /// Runs `work` as a named phase: timed, and shown on a terminal while it lasts. Phases of the
  /// same name add up. Work that takes a ProgressLine can tell there how far it is.
  template <class Work>
  auto phase(const char* name, Work&& work) {
    Phase running(*this, name);
    if constexpr (std::is_invocable_v<Work, ProgressLine&>)
      return std::forward<Work>(work)(running.line);
    else
      return std::forward<Work>(work)();
  }

  /// Adds to the bytes that a phase has to read and write at least, for its rate.
  void moved(const char* phase, double bytes);

  /// What the program returns when nothing is thrown; 0 unless set.
  void set_exit_code(int code) { exit_code_ = code; }
  int exit_code() const { return exit_code_; }

  /// The object as it would be printed now.
  Json snapshot() const;
  /// Prints the JSON object, or the line of times.
  /// \throws IoError  standard output cannot be written
  void finish();

 private:
  struct Phase {
    Phase(Session& session, const char* name);
    ~Phase();
    Phase(const Phase&) = delete;
    Phase& operator=(const Phase&) = delete;
    Session& session;
    const char* name;
    std::chrono::steady_clock::time_point start;
    ProgressLine line;
  };
  struct PhaseCost {
    std::string name;
    double seconds = 0, bytes = 0;
  };
  PhaseCost& cost_of(const std::string& phase);

  CommonOptions options_;
  int exit_code_ = 0;
  Json report_;
  std::vector<PhaseCost> costs_;
  Json notes_ = Json::array();
  Json diagnostics_ = Json::object();
};

/// Prints an object on standard output.
/// \throws IoError  it cannot be written
void print_json(const Json& object);

/// Text of a number for people: six digits.
std::string text(double value);
/// "1 face", "2 faces".
std::string count(std::int64_t n, const std::string& noun);
/// "2 faces of one cell", "1 face of one cell": the first noun follows the number.
std::string describe_count(std::int64_t n, std::string what);
/// The first hundred entries: enough to find the spot, small enough to read.
Json first_elements(const std::vector<std::int64_t>& elements);

}  // namespace carat::cli
