#pragma once
// Statistics of meshes as lines for people and objects for JSON.

#include "carat/mesh/statistics.h"
#include "carat/mesh/volume_statistics.h"
#include "cli/session.h"

namespace carat::cli {

/// Reports under "statistics".
void report_statistics(Session& session, const MeshStatistics& statistics);
void report_statistics(Session& session, const VolumeStatistics& statistics);

}  // namespace carat::cli
