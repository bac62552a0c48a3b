// Where the real scans lie that are not part of the source tree: $TILTMAP_SHARED_DATA, else ../shared/data.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace tiltmap::test {

inline std::filesystem::path sharedData(const std::string& name) {
  const char* folder = std::getenv("TILTMAP_SHARED_DATA");
  const std::filesystem::path root =
      folder ? std::filesystem::path(folder)
             : std::filesystem::path(TILTMAP_SOURCE_DIR) / ".." / "shared" / "data";
  return root / name;
}

}  // namespace tiltmap::test

// Ends the test as skipped where the folder is absent.
#define TILTMAP_NEEDS_SHARED_DATA(name)                            \
  if (!std::filesystem::exists(::tiltmap::test::sharedData(name))) \
  GTEST_SKIP() << ::tiltmap::test::sharedData(name) << " is absent; set TILTMAP_SHARED_DATA to where it is"
