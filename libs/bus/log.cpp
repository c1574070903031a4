#include "bus/log.hpp"

#include <lcm/lcm-cpp.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace noctule::bus {

// ---- writer

struct LogWriter::File {
  explicit File(const std::filesystem::path& path) : log(path.string(), "w") {}
  lcm::LogFile log;
};

LogWriter::LogWriter(const std::filesystem::path& path) : path_(path), file_(std::make_unique<File>(path)) {
  if (!file_->log.good())
    throw InputError(path.string() + ": expected a log file that can be written, got: " + std::strerror(errno));
}
LogWriter::LogWriter(LogWriter&&) noexcept = default;
LogWriter& LogWriter::operator=(LogWriter&&) noexcept = default;
LogWriter::~LogWriter() = default;

void LogWriter::write(const std::string& channel, std::int64_t utime, Bytes data) {
  lcm::LogEvent event{};
  event.timestamp = utime;
  event.channel = channel;
  event.datalen = static_cast<std::int32_t>(data.size());
  event.data = const_cast<std::uint8_t*>(data.data());  // LCM only reads it
  if (file_->log.writeEvent(&event) != 0 || std::fflush(file_->log.getFilePtr()) != 0)
    throw InputError(path_.string() + ": expected room for the log, got: " + std::strerror(errno));
}

// ---- reader
//
// An event is: sync word, event number (8 bytes), time [us] (8), length of channel (4), length of data (4), channel,
// data; big-endian.

namespace {

constexpr std::uint64_t kSync = 0xeda1da01;
constexpr std::uintmax_t kHeaderSize = 28;
constexpr std::uint64_t kMaxChannel = 255;
constexpr std::uint64_t kMaxData = 1 << 30;

std::uint64_t big_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

}  // namespace

LogReader::LogReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code error;
  if (file_) size_ = std::filesystem::file_size(path, error);
  if (!file_ || error)
    throw InputError(path.string() + ": expected an LCM log, got: " + (error ? error.message() : std::strerror(errno)));
}

std::optional<LogEvent> LogReader::next() {
  const std::uintmax_t left = size_ - offset_;
  const auto corrupt = [this](const std::string& what) {
    return InputError(path_.string() + ": byte " + std::to_string(offset_) + ": expected an event of an LCM log, got " +
                      what);
  };

  std::array<std::uint8_t, kHeaderSize> header{};
  const auto header_size = std::min(left, kHeaderSize);
  file_.read(reinterpret_cast<char*>(header.data()), static_cast<std::streamsize>(header_size));
  if (header_size >= 4 && big_endian(header.data(), 4) != kSync) throw corrupt("no sync word");
  if (header_size < kHeaderSize) return cut_off(left);

  const std::uint64_t channel_size = big_endian(header.data() + 20, 4);
  const std::uint64_t data_size = big_endian(header.data() + 24, 4);
  if (channel_size == 0 || channel_size > kMaxChannel)
    throw corrupt("a channel name of " + std::to_string(channel_size) + " bytes");
  if (data_size > kMaxData) throw corrupt("a message of " + std::to_string(data_size) + " bytes");
  if (channel_size + data_size > left - kHeaderSize) return cut_off(left);

  LogEvent event;
  event.utime = static_cast<std::int64_t>(big_endian(header.data() + 12, 8));
  event.channel.resize(channel_size);
  event.data.resize(data_size);
  file_.read(event.channel.data(), static_cast<std::streamsize>(channel_size));
  file_.read(reinterpret_cast<char*>(event.data.data()), static_cast<std::streamsize>(data_size));
  if (!file_) throw corrupt(std::string("an error: ") + std::strerror(errno));
  offset_ += kHeaderSize + channel_size + data_size;
  return event;
}

std::nullopt_t LogReader::cut_off(std::uintmax_t bytes) {
  truncated_bytes_ += bytes;
  offset_ = size_;
  return std::nullopt;
}

}  // namespace noctule::bus
