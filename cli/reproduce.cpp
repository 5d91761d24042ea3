// carat reproduce: the experiments of the paper, and ours, with their data and figures.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>

#include "carat/base/atomic_file.h"
#include "carat/base/error.h"
#include "carat/base/parallel.h"
#include "carat/generators/families.h"
#include "carat/report/page_blocks.h"
#include "cli/command.h"
#include "cli/experiments/experiment.h"
#include "cli/figures.h"
#include "cli/report_page.h"

namespace carat::cli {
namespace {

namespace fs = std::filesystem;

/// A scanned rabbit: in Debian's package glmark2-data.
constexpr const char* kModel = "/usr/share/glmark2/models/bunny.obj";

struct Options {
  std::vector<std::string> names;
  std::string directory, model = kModel;
  std::optional<int> levels;
  bool quick = false, fresh = false;
};

void write_text(const fs::path& path, const std::string& content) {
  write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << content;
    file.close();
    if (!file) throw IoError("cannot write " + path.string());
  });
}

/// FNV-1a: names of cache files. Collisions are noticed, as a file holds its whole key.
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 1099511628211ull;
  }
  char name[17];
  std::snprintf(name, sizeof name, "%016llx", static_cast<unsigned long long>(hash));
  return name;
}

/// Results of cases, one file each.
class Cache {
 public:
  Cache(fs::path folder, bool fresh) : folder_(std::move(folder)), fresh_(fresh) {
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw IoError("cannot make the folder " + folder_.string() + ": " + error.message());
  }
  std::optional<Json> find(const std::string& key, Session& session) const {
    if (fresh_) return std::nullopt;
    const fs::path path = path_of(key);
    std::ifstream file(path);
    if (!file) return std::nullopt;
    const Json stored = Json::parse(file, nullptr, false);
    if (stored.is_object() && stored.contains("key") && stored.contains("rows") &&
        stored["rows"].is_array()) {
      if (stored["key"] == key) return stored;
      return std::nullopt;
    }
    session.note("the cached result " + path.string() + " is damaged; it is measured again");
    return std::nullopt;
  }
  void store(const std::string& key, Json result) const {
    result["key"] = key;
    write_text(path_of(key), result.dump());
  }

 private:
  fs::path path_of(const std::string& key) const { return folder_ / (hash_of(key) + ".json"); }

  fs::path folder_;
  bool fresh_;
};

Json machine() {
  Json json{{"cpu", nullptr},
            {"cores", resolve_threads(0)},
            {"memory_bytes", nullptr},
            {"system", nullptr}};
  const auto find = [](const char* path, const std::string& label) -> std::string {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);)
      if (line.rfind(label, 0) == 0) {
        const std::size_t begin = line.find_first_not_of(" \t:=\"", label.size());
        if (begin == std::string::npos) return "";
        return line.substr(begin, line.find_last_not_of("\" ") - begin + 1);
      }
    return "";
  };
  if (const std::string cpu = find("/proc/cpuinfo", "model name"); !cpu.empty()) json["cpu"] = cpu;
  if (const std::string system = find("/etc/os-release", "PRETTY_NAME"); !system.empty())
    json["system"] = system;
  if (const std::string memory = find("/proc/meminfo", "MemTotal"); !memory.empty())
    json["memory_bytes"] = std::stoll(memory) * 1024;
  return json;
}

/// Progress over all cases; time left from the mean of those measured.
class Progress {
 public:
  explicit Progress(std::size_t n) : n_(n), line_("") {}
  void next(const std::string& what) {
    ++done_;
    std::string text = std::to_string(done_) + "/" + std::to_string(n_) + " " + what;
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (done_ > 10 && elapsed > 2) {
      const double left =
          elapsed / static_cast<double>(done_ - 1) * static_cast<double>(n_ - done_ + 1);
      text += left > 90 ? ", about " + std::to_string(std::lround(left / 60)) + " min left,"
                        : ", about " + std::to_string(std::lround(left)) + " s left,";
    }
    line_.show(text);
  }

 private:
  std::size_t n_, done_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  ProgressLine line_;
};

std::string describe(const Json& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters.items()) {
    if (value.is_null()) continue;
    text += (text.empty() ? "" : " ") +
            (value.is_string() ? value.get<std::string>() : name + ' ' + value.dump());
  }
  return text;
}

struct Counts {
  int measured = 0, cached = 0, failed = 0;
};

/// All rows of an experiment's cases. A case that fails has one row of its parameters.
std::vector<Json> run_cases(Session& session, const Experiment& experiment,
                            const std::vector<ExperimentCase>& cases, const Cache& cache,
                            Progress& progress, Counts& counts, double& seconds) {
  std::vector<Json> rows;
  for (const ExperimentCase& one : cases) {
    progress.next(std::string(experiment.name) + ": " + describe(one.parameters));
    const std::string key =
        std::string(CARAT_VERSION) + ' ' + experiment.name + ' ' + one.parameters.dump();
    std::optional<Json> result = cache.find(key, session);
    if (result) {
      ++counts.cached;
    } else {
      const auto start = std::chrono::steady_clock::now();
      bool failed = false;
      result = Json{{"rows", Json::array()}};
      try {
        for (Json& row : one.measure()) (*result)["rows"].push_back(std::move(row));
        ++counts.measured;
      } catch (const Error& error) {
        failed = true;
        ++counts.failed;
        session.note(std::string(experiment.name) + ", " + describe(one.parameters) + ": " +
                     error.what());
        (*result)["rows"].push_back(Json::object());
      }
      (*result)["seconds"] =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      // A failure is tried again, and said again, in the next run.
      if (!failed) cache.store(key, *result);
    }
    seconds += result->value("seconds", 0.0);
    for (const Json& values : (*result)["rows"]) {
      Json row = one.parameters;
      row.update(values);
      rows.push_back(std::move(row));
    }
  }
  if (experiment.finish != nullptr) experiment.finish(rows);
  return rows;
}

Json to_json(const Experiment& experiment, const std::vector<Json>& rows, double seconds) {
  Json json{{"name", experiment.name},
            {"title", experiment.title},
            {"paper", experiment.paper != nullptr ? Json(experiment.paper) : Json(nullptr)},
            {"text", experiment.text},
            {"command", std::string("carat reproduce ") + experiment.name + " -o DIR"},
            {"seconds", seconds},
            {"columns", Json::array()},
            {"rows", Json::array()},
            {"figures", experiment.figures()}};
  for (const ExperimentColumn& column : experiment.columns)
    json["columns"].push_back({{"name", column.name},
                               {"title", column.title},
                               {"unit", column.unit},
                               {"kind", column.kind}});
  for (const Json& row : rows) {
    Json cells = Json::array();
    for (const ExperimentColumn& column : experiment.columns) {
      const auto found = row.find(column.name);
      cells.push_back(found != row.end() ? *found : Json(nullptr));
    }
    json["rows"].push_back(std::move(cells));
  }
  return json;
}

std::string to_csv(const Json& experiment) {
  std::string text;
  for (const Json& column : experiment["columns"])
    text += (text.empty() ? "" : ",") + column["name"].get<std::string>();
  text += '\n';
  for (const Json& row : experiment["rows"]) {
    bool first = true;
    for (const Json& cell : row) {
      if (!first) text += ',';
      first = false;
      if (cell.is_string() && cell.get<std::string>().find(',') != std::string::npos)
        text += '"' + cell.get<std::string>() + '"';
      else if (cell.is_string())
        text += cell.get<std::string>();
      else if (!cell.is_null())
        text += cell.dump();
    }
    text += '\n';
  }
  return text;
}

std::vector<const Experiment*> chosen(const std::vector<std::string>& names) {
  if (names.empty()) return experiments();
  std::vector<const Experiment*> list;
  for (const Experiment* experiment : experiments())
    if (std::find(names.begin(), names.end(), experiment->name) != names.end())
      list.push_back(experiment);
  return list;
}

/// What the figures of kind "picture" show; nothing if it cannot be made, which a case has said.
std::vector<ViewItem> pictures_of(const Experiment& experiment, const Extent& extent) {
  if (experiment.pictures == nullptr) return {};
  try {
    return experiment.pictures(extent);
  } catch (const Error&) {
    return {};
  }
}

/// The families that an experiment measures on, at a level at which one sees their faces.
std::vector<ViewItem> family_meshes(const std::vector<Json>& rows) {
  constexpr int kFinestSurface = 2, kFinestVolume = 1;
  std::vector<ViewItem> items;
  std::set<std::string> seen;
  for (const Json& row : rows) {
    const auto found = row.find("family");
    if (found == row.end() || !seen.insert(*found).second) continue;
    const std::string family = *found;
    const bool volume = family.rfind("cube-", 0) == 0 || family.rfind("ball-", 0) == 0;
    const int level = std::min(row.at("level").get<int>(), volume ? kFinestVolume : kFinestSurface);
    const FamilyOptions options{.level = level};
    if (volume)
      items.push_back({family, VolumeData{generate_volume(family, options), {}}});
    else
      items.push_back({family, SurfaceData{generate_mesh(family, options), {}}});
  }
  return items;
}

/// A file's bytes as the address of an image.
std::string image_address(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return "data:image/png;base64," +
         detail::base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// What the page shows beyond the data: meshes and pictures.
Json with_views(Json experiment, const std::vector<ViewItem>& items, const fs::path& directory) {
  if (!items.empty()) experiment["view"] = html_view_data(items, "Meshes");
  for (Json& figure : experiment["figures"])
    if (figure["kind"] == "picture")
      figure["image"] = image_address(directory / (figure["id"].get<std::string>() + ".png"));
  return experiment;
}

void run(Session& session, const Options& options) {
  const fs::path directory = options.directory;
  const Cache cache(directory / "cache", options.fresh);
  const Extent extent{options.levels, options.quick, session.threads(), options.model};
  const std::vector<const Experiment*> list = chosen(options.names);
  std::vector<std::vector<ExperimentCase>> cases;
  std::size_t n_cases = 0;
  for (const Experiment* experiment : list) {
    cases.push_back(experiment->plan(extent));
    n_cases += cases.back().size();
  }
  Json header{{"format", 1},
              {"carat", CARAT_VERSION},
              {"machine", machine()},
              {"seed", FamilyOptions{}.seed},
              {"options",
               {{"levels", options.levels ? Json(*options.levels) : Json(nullptr)},
                {"quick", options.quick},
                {"threads", resolve_threads(session.threads())}}}};
  Json report = header;
  report["experiments"] = Json::array();
  Json shown = Json::array();
  Counts counts;
  double all_seconds = 0;
  Progress progress(n_cases);
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Experiment& experiment = *list[k];
    double seconds = 0;
    const std::vector<Json> rows =
        run_cases(session, experiment, cases[k], cache, progress, counts, seconds);
    all_seconds += seconds;
    Json result = to_json(experiment, rows, seconds);
    std::vector<ViewItem> items = pictures_of(experiment, extent);
    if (items.empty())
      std::erase_if(result["figures"].get_ref<Json::array_t&>(),
                    [](const Json& figure) { return figure["kind"] == "picture"; });
    Json alone = header;
    alone["seconds"] = seconds;
    alone["experiments"] = Json::array({result});
    write_text(directory / (std::string(experiment.name) + ".json"), alone.dump(1) + "\n");
    write_text(directory / (std::string(experiment.name) + ".csv"), to_csv(result));
    write_figures(result, directory.string(), items);
    if (items.empty()) items = family_meshes(rows);
    shown.push_back(with_views(result, items, directory));
    report["experiments"].push_back(std::move(result));
    session.say(std::string(experiment.name) + ": " + count(std::ssize(rows), "row"));
  }
  report["seconds"] = all_seconds;
  write_text(directory / "report.json", report.dump(1) + "\n");
  Json page = report;
  page["experiments"] = std::move(shown);
  write_report_page(std::move(page), directory / "report.html");
  Json summary = Json::array();
  for (const Json& experiment : report["experiments"])
    summary.push_back({{"name", experiment["name"]},
                       {"rows", experiment["rows"].size()},
                       {"seconds", experiment["seconds"]}});
  session.report()["experiments"] = summary;
  session.report()["cases"] = {
      {"measured", counts.measured}, {"cached", counts.cached}, {"failed", counts.failed}};
  session.report()["output"] = options.directory;
  session.say(std::to_string(counts.measured) + " cases measured, " +
              std::to_string(counts.cached) + " taken from " + (directory / "cache").string() +
              ", " + std::to_string(counts.failed) + " failed");
}

std::function<void(Session&)> declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  std::vector<std::string> names;
  for (const Experiment* experiment : experiments()) names.emplace_back(experiment->name);
  app.add_option("EXPERIMENT", options->names, "Only these; see carat list experiments")
      ->check(CLI::IsMember(names))
      ->option_text("...");
  app.add_option("-o,--output", options->directory,
                 "Folder for the data; it is made if it does not exist")
      ->required();
  app.add_option("--levels", options->levels,
                 "Number of refinement levels of experiments that refine")
      ->check(CLI::Range(1, 8));
  app.add_option("--model", options->model,
                 "Surface of the experiments with pictures; its triangles\n"
                 "are made into polygons")
      ->capture_default_str();
  app.add_flag("--quick", options->quick, "Coarse meshes: all experiments in two minutes");
  app.add_flag("--fresh", options->fresh, "Measure again what the folder's cache holds");
  return [options](Session& session) { run(session, *options); };
}

}  // namespace

const Command reproduce_command = {
    "reproduce",
    "Measure the experiments of the paper, and ours",
    "Every experiment writes its data as CSV and JSON, with all parameters that it takes to "
    "repeat\n"
    "a row, and its figures as SVG and PNG; report.html shows them all. Results are kept in the\n"
    "folder's cache, so that an interrupted run goes on.",
    "  carat reproduce --quick -o results\n"
    "  carat reproduce franke-plane harmonic-sphere -o results\n"
    "  carat reproduce columns --fresh -o results --json\n",
    false,
    declare};

}  // namespace carat::cli
