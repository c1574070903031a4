#pragma once
/// LCM log files, as lcm-logger writes and lcm-logplayer and lcm-logplayer-gui read them.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/codec.hpp"

namespace noctule::bus {

struct LogEvent {
  std::int64_t utime = 0;  ///< [us] of the message in our logs, of its arrival in lcm-logger's
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Appends messages to a new log. Each one is handed to the system before write() returns, so that a killed run leaves
/// every message written. The bytes depend on the arguments alone.
class LogWriter {
 public:
  /// \throws InputError when the file cannot be created
  explicit LogWriter(const std::filesystem::path& path);
  LogWriter(LogWriter&&) noexcept;
  LogWriter& operator=(LogWriter&&) noexcept;
  ~LogWriter();

  /// \param utime when the message was measured [us]
  /// \throws InputError when the file cannot take it (disk full)
  void write(const std::string& channel, std::int64_t utime, Bytes data);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct File;
  std::filesystem::path path_;
  std::unique_ptr<File> file_;
};

/// Reads a log from its beginning. LCM's own reader is not used: it skips over corrupt bytes and cannot tell a log that
/// was cut off from one that ended.
class LogReader {
 public:
  /// \throws InputError when the file cannot be opened
  explicit LogReader(const std::filesystem::path& path);

  /// The next event, or nothing at the end.
  /// \throws InputError naming file and byte where the bytes are no log
  [[nodiscard]] std::optional<LogEvent> next();

  /// Bytes of an unfinished event at the end of the file, known once next() has returned nothing; 0 for a log that was
  /// closed or whose writer died between two messages.
  [[nodiscard]] std::uintmax_t truncated_bytes() const { return truncated_bytes_; }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::nullopt_t cut_off(std::uintmax_t bytes);

  std::filesystem::path path_;
  std::ifstream file_;
  std::uintmax_t size_ = 0;
  std::uintmax_t offset_ = 0;
  std::uintmax_t truncated_bytes_ = 0;
};

}  // namespace noctule::bus
