#pragma once
// Franke's function, under the name of the tests.

#include "carat/report/franke.h"

namespace carat::test {
using namespace measures;
}  // namespace carat::test
