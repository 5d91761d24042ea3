#include "carat/generators/families.h"

#include <algorithm>
#include <string>

#include "carat/base/error.h"
#include "carat/generators/volume_domain.h"

namespace carat {

#define CARAT_FAMILY(suffix, name, title, domain) \
  PolygonMesh generate_##suffix(const FamilyOptions& options);
#include "carat/generators/families.def"
#undef CARAT_FAMILY

#define CARAT_VOLUME_FAMILY(suffix, name, title) \
  PolyhedralMesh generate_##suffix(const VolumeDomain& domain, const FamilyOptions& options);
#include "carat/generators/volume_families.def"
#undef CARAT_VOLUME_FAMILY

namespace {

constexpr double kMaxJitter = 0.5;
constexpr double kMaxAnisotropy = 1000;

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

template <class Mesh>
Mesh generate(const std::vector<FamilyEntryOf<Mesh>>& families, const char* kind,
              const std::string& family, const FamilyOptions& options) {
  const auto entry = std::find_if(families.begin(), families.end(),
                                  [&](const auto& known) { return known.name == family; });
  if (entry == families.end()) {
    std::string names;
    for (const auto& known : families)
      names += (names.empty() ? "" : ", ") + std::string(known.name);
    throw InvalidOption(std::string(kind) + " family '" + family + "' is unknown; choose one of " +
                        names);
  }
  check_options(options);
  return entry->generate(options);
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
  static const std::vector<VolumeFamilyEntry> families{
#define CARAT_VOLUME_FAMILY(suffix, name, title) \
  {"cube-" name, title, "unit cube",             \
   [](const FamilyOptions& options) { return generate_##suffix(kCube, options); }},
#include "carat/generators/volume_families.def"
#undef CARAT_VOLUME_FAMILY
#define CARAT_VOLUME_FAMILY(suffix, name, title) \
  {"ball-" name, title, "unit ball",             \
   [](const FamilyOptions& options) { return generate_##suffix(kBall, options); }},
#include "carat/generators/volume_families.def"
#undef CARAT_VOLUME_FAMILY
  };
  return families;
}

PolygonMesh generate_mesh(const std::string& family, const FamilyOptions& options) {
  return generate(mesh_families(), "mesh", family, options);
}

PolyhedralMesh generate_volume(const std::string& family, const FamilyOptions& options) {
  return generate(volume_families(), "volume mesh", family, options);
}

}  // namespace carat
