#pragma once
// The measures of the claims about volumes, under the name of the tests.

#include "carat/report/volume_measures.h"
#include "support/measures.h"

namespace carat::test {
using namespace measures;
}  // namespace carat::test
