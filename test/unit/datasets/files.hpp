#pragma once
/// Files for the tests of readers: written by the tests themselves, or recordings that may be absent.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/source.hpp"

namespace noctule::datasets {

/// A folder that vanishes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("noctule_datasets_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// A folder of recorded data: below $NOCTULE_SHARED, else beside the source tree. Nothing where it is absent.
inline std::optional<std::filesystem::path> recorded(const std::string& name) {
  const char* shared = std::getenv("NOCTULE_SHARED");
  const std::filesystem::path root =
      shared != nullptr ? std::filesystem::path(shared) : std::filesystem::path(NOCTULE_SOURCE_DIR) / ".." / "shared";
  const std::filesystem::path path = root / "data" / name;
  return std::filesystem::exists(path) ? std::optional(path) : std::nullopt;
}

/// Everything that a source yields.
inline std::vector<Observation> all(ObservationSource& source) {
  std::vector<Observation> observations;
  while (auto observation = source.next()) observations.push_back(std::move(*observation));
  return observations;
}

/// Those of one kind.
template <class Kind>
std::vector<Kind> only(const std::vector<Observation>& observations) {
  std::vector<Kind> kind;
  for (const Observation& o : observations) {
    if (const Kind* value = std::get_if<Kind>(&o)) kind.push_back(*value);
  }
  return kind;
}

/// The text of the InputError that an action throws; empty and a failure when it throws none.
template <class Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << "more than one line: " << text;
    return text;
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace noctule::datasets

/// Skips a test whose recording is absent, else defines `folder`.
#define NOCTULE_RECORDED(folder, name)                                                             \
  const auto folder##_found = ::noctule::datasets::recorded(name);                                 \
  if (!folder##_found) GTEST_SKIP() << "recorded data '" << (name) << "' are not on this machine"; \
  const std::filesystem::path& folder = *folder##_found
