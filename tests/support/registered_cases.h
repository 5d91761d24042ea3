#pragma once
// What tests there are in this program: the claims are counted against the registries.

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

namespace carat::test {

/// Tests of the suites instantiated under `prefix`, "Suite.test" -> number of cases; repeated names
/// would hide cases.
inline std::map<std::string, int> registered_cases(const std::string& prefix) {
  std::map<std::string, int> counts;
  std::set<std::string> names;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    const std::string suite_name = suite.name();
    if (suite_name.rfind(prefix + "/", 0) != 0) continue;
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const testing::TestInfo& info = *suite.GetTestInfo(t);
      const std::string test = info.name();
      const std::string claim =
          suite_name.substr(prefix.size() + 1) + "." + test.substr(0, test.find('/'));
      ++counts[claim];
      EXPECT_TRUE(names.insert(claim + test).second) << test << " is there twice";
      EXPECT_EQ(test.find("DISABLED"), std::string::npos) << test;
    }
  }
  return counts;
}

}  // namespace carat::test
