#pragma once
// The measures of the claims, under the name of the tests.

#include "carat/report/measures.h"

namespace carat::test {
using namespace measures;
}  // namespace carat::test
