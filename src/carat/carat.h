#pragma once
// Everything of carat::core that a program needs: meshes, operators, solvers, problems.

#include "carat/apps/boundary_conditions.h"
#include "carat/apps/eigenmodes.h"
#include "carat/apps/heat_geodesics.h"
#include "carat/apps/mean_curvature.h"
#include "carat/apps/poisson.h"
#include "carat/base/error.h"
#include "carat/generators/families.h"
#include "carat/mesh/fields.h"
#include "carat/mesh/polygon_mesh.h"
#include "carat/mesh/polyhedral_mesh.h"
#include "carat/mesh/statistics.h"
#include "carat/mesh/transform.h"
#include "carat/mesh/volume_statistics.h"
#include "carat/operators/registry.h"
#include "carat/solve/eigen_solver.h"
#include "carat/solve/spd_solver.h"
