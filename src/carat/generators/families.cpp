#include "carat/generators/families.h"

#include <algorithm>
#include <string>

#include "carat/base/error.h"

namespace carat {

#define CARAT_FAMILY(suffix, name, title, domain) \
  PolygonMesh generate_##suffix(const FamilyOptions& options);
#include "carat/generators/families.def"
#undef CARAT_FAMILY

namespace {

constexpr double kMaxJitter = 0.5;
constexpr double kMaxAnisotropy = 1000;

std::string known_families() {
  std::string names;
  for (const FamilyEntry& family : mesh_families())
    names += (names.empty() ? "" : ", ") + std::string(family.name);
  return names;
}

// The comparisons are written so that a NaN fails them.
void check_options(const FamilyOptions& options) {
  if (options.level < 0)
    throw InvalidOption("level " + std::to_string(options.level) +
                        ": a refinement level is 0 or more");
  if (!(options.jitter >= 0 && options.jitter <= kMaxJitter))
    throw InvalidOption("jitter " + std::to_string(options.jitter) +
                        ": it must lie between 0 and 0.5 of the shortest edge");
  if (!(options.anisotropy >= 1 && options.anisotropy <= kMaxAnisotropy))
    throw InvalidOption("anisotropy " + std::to_string(options.anisotropy) +
                        ": it must lie between 1 (none) and 1000");
}

}  // namespace

const std::vector<FamilyEntry>& mesh_families() {
  static const std::vector<FamilyEntry> families{
#define CARAT_FAMILY(suffix, name, title, domain) {name, title, domain, &generate_##suffix},
#include "carat/generators/families.def"
#undef CARAT_FAMILY
  };
  return families;
}

const std::vector<VolumeFamilyEntry>& volume_families() {
  static const std::vector<VolumeFamilyEntry> families;
  return families;
}

PolygonMesh generate_mesh(const std::string& family, const FamilyOptions& options) {
  const auto& families = mesh_families();
  const auto entry = std::find_if(families.begin(), families.end(),
                                  [&](const FamilyEntry& known) { return known.name == family; });
  if (entry == families.end())
    throw InvalidOption("mesh family '" + family + "' is unknown; choose one of " +
                        known_families());
  check_options(options);
  return entry->generate(options);
}

}  // namespace carat
