#include "bus/log.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <lcm/lcm-cpp.hpp>

#include <csignal>
#include <fstream>

#include "bus/bus.hpp"
#include "core/rng.hpp"
#include "unit/bus/messages.hpp"

namespace noctule::bus {
namespace {

namespace fs = std::filesystem;

class Log : public testing::Test {
 protected:
  Log() : path_(fs::path(testing::TempDir()) / ("log_test_" + std::to_string(getpid()) + ".lcmlog")) {}
  ~Log() override { fs::remove(path_); }

  static void write(LogWriter& writer, std::int64_t seq) {
    writer.write("ODOMETRY", 1000 * seq, bytes_of(make_odometry(seq)));
  }
  void write_events(int count) const {
    LogWriter writer(path_);
    for (int i = 0; i < count; ++i) write(writer, i);
  }
  [[nodiscard]] std::string content() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void set_content(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  /// Number of events that are read before the end, all intact.
  static int count_events(LogReader& reader) {
    int count = 0;
    while (const auto event = reader.next()) {
      EXPECT_EQ(event->channel, "ODOMETRY");
      EXPECT_EQ(event->utime, 1000 * count);
      EXPECT_EQ(event->data, bytes_of(make_odometry(count)));
      ++count;
    }
    return count;
  }

  fs::path path_;
};

TEST_F(Log, ReadsWhatWasWritten) {
  write_events(20);
  LogReader reader(path_);
  EXPECT_EQ(count_events(reader), 20);
  EXPECT_EQ(reader.truncated_bytes(), 0u);
  EXPECT_FALSE(reader.next().has_value());
}

TEST_F(Log, LcmReadsIt) {
  write_events(20);
  lcm::LogFile log(path_.string(), "r");
  ASSERT_TRUE(log.good());
  for (int i = 0; i < 20; ++i) {
    const lcm::LogEvent* event = log.readNextEvent();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1000 * i);
    EXPECT_EQ(event->channel, "ODOMETRY");
    EXPECT_EQ(event->datalen, static_cast<int>(bytes_of(make_odometry(i)).size()));
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST_F(Log, TheBytesDependOnTheMessagesAlone) {
  write_events(20);
  const std::string first = content();
  usleep(2000);
  write_events(20);
  EXPECT_EQ(content(), first);
}

TEST_F(Log, ABusRecordsWhatItPublishesButWhatIsExcepted) {
  {
    Bus bus;
    bus.record_to(LogWriter(path_), {"TIMING"});
    for (int i = 0; i < 5; ++i) {
      bus.publish("ODOMETRY", make_odometry(i));
      bus.publish("TIMING", make_odometry(i));
    }
  }
  LogReader reader(path_);
  EXPECT_EQ(count_events(reader), 5);
}

TEST_F(Log, EveryTruncationLeavesTheEventsBeforeIt) {
  write_events(3);
  const std::string whole = content();
  const std::size_t event_size = whole.size() / 3;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    set_content(whole.substr(0, size));
    LogReader reader(path_);
    EXPECT_EQ(count_events(reader), static_cast<int>(size / event_size));
    EXPECT_EQ(reader.truncated_bytes(), size % event_size);
    EXPECT_FALSE(reader.next().has_value()) << "the end stays the end";
  }
}

TEST_F(Log, AKilledWriterLeavesEveryMessageWritten) {
  const pid_t child = fork();
  if (child == 0) {
    LogWriter writer(path_);
    for (int i = 0; i < 100; ++i) write(writer, i);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  LogReader reader(path_);
  EXPECT_EQ(count_events(reader), 100);
}

std::string refusal(const fs::path& path) {
  try {
    LogReader reader(path);
    while (reader.next()) {
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_F(Log, CorruptBytesAreNamedByTheirPlace) {
  write_events(3);
  const std::string whole = content();
  const std::size_t event_size = whole.size() / 3;
  const auto with_byte = [&](std::size_t at, char value) {
    std::string bytes = whole;
    bytes[at] = value;
    set_content(bytes);
    return refusal(path_);
  };
  const std::string second =
      path_.string() + ": byte " + std::to_string(event_size) + ": expected an event of an LCM log, got ";
  EXPECT_EQ(with_byte(event_size, 'x'), second + "no sync word");
  EXPECT_EQ(with_byte(event_size + 22, 1), second + "a channel name of 264 bytes");
  EXPECT_EQ(with_byte(event_size + 24, 0x70).substr(0, second.size()), second);
}

/// Whatever the bytes: events, the end or an InputError, and never more memory than the file is long.
TEST_F(Log, SurvivesCorruptBytes) {
  write_events(3);
  const std::string whole = content();
  Rng rng(1, stream_id("log"));
  int accepted = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 4; ++k) bytes[rng.index(bytes.size())] = static_cast<char>(rng());
    set_content(bytes);
    if (refusal(path_) == "accepted") ++accepted;
  }
  EXPECT_GT(accepted, 0) << "corrupt messages are not the reader's to judge";
}

TEST_F(Log, OtherFilesAreRefused) {
  set_content("# a text file\n");
  EXPECT_EQ(refusal(path_), path_.string() + ": byte 0: expected an event of an LCM log, got no sync word");
  EXPECT_EQ(refusal("/nonexistent/run.lcmlog"),
            "/nonexistent/run.lcmlog: expected an LCM log, got: No such file or directory");
  EXPECT_EQ(refusal(testing::TempDir()).substr(testing::TempDir().size()),
            ": expected an LCM log, got: Is a directory");
}

TEST_F(Log, AnEmptyLogHasNoEvents) {
  set_content("");
  EXPECT_EQ(refusal(path_), "accepted");
}

TEST_F(Log, AFolderThatCannotBeWrittenIsRefused) {
  EXPECT_THROW(LogWriter("/nonexistent/run.lcmlog"), InputError);
}

TEST_F(Log, AFullDiskIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  LogWriter writer("/dev/full");
  EXPECT_THROW(write(writer, 0), InputError);
}

TEST_F(Log, AHandlerCannotHideAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  Bus bus;
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry& m) {
    try {
      bus.publish("OTHER", m);
    } catch (const InputError&) {
    }
  });
  bus.publish("ODOMETRY", make_odometry(0));
  bus.record_to(LogWriter("/dev/full"));
  EXPECT_THROW(bus.drain(), InputError);
  bus.publish("ODOMETRY", make_odometry(1));
  EXPECT_EQ(bus.drain(), 1) << "the bus goes on without a log";
}

}  // namespace
}  // namespace noctule::bus
