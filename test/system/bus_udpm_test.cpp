/// The bus between two LCM objects over UDP multicast on this host, and beside LCM's own tools.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "bus/bus.hpp"
#include "bus/url.hpp"
#include "unit/bus/messages.hpp"

namespace noctule::bus {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// A port that nobody uses now, never LCM's own.
int free_port() {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  socklen_t size = sizeof address;
  bind(fd, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  close(fd);
  return ntohs(address.sin_port);
}

class Udpm : public testing::Test {
 protected:
  void SetUp() override {
    if (probe_multicast(address_) != 0) GTEST_SKIP() << "no multicast on this host";
  }
  [[nodiscard]] std::string url() const { return to_url(address_); }

  /// Handles messages until `done` or the patience of a slow machine ends.
  template <class Done>
  static void handle_until(Bus& bus, Done done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!done() && std::chrono::steady_clock::now() < end) bus.handle_for(milliseconds(20));
  }

  UdpmAddress address_{.port = free_port()};
};

TEST_F(Udpm, ABurstLongerThanLcmsDefaultQueueArrivesWhole) {
  Bus sender(url()), receiver(url());
  const Reception& reception = receiver.subscribe<odometry>("ODOMETRY", [](const odometry&) {});
  for (std::int64_t seq = 0; seq < 100; ++seq) {
    sender.publish("ODOMETRY", make_odometry(seq));
    if (seq % 10 == 9) std::this_thread::sleep_for(milliseconds(1));  // the kernel's buffer is not what is tested
  }
  std::this_thread::sleep_for(milliseconds(100));
  handle_until(receiver, [&] { return reception.sequence.used == 100; });
  EXPECT_EQ(reception.sequence.used, 100);
  EXPECT_EQ(reception.sequence.missed, 0);
}

TEST_F(Udpm, TruncatedAndForeignDatagramsAreRefusedAndTheRestArrives) {
  Bus sender(url()), receiver(url());
  const Reception& reception = receiver.subscribe<odometry>("ODOMETRY", [](const odometry&) {});
  const auto bytes = bytes_of(make_odometry(0));
  sender.publish_bytes("ODOMETRY", 0, Bytes(bytes).first(40));
  sender.publish("ODOMETRY", make_scan(0, 3));
  sender.publish("ODOMETRY", make_odometry(1));
  handle_until(receiver, [&] { return reception.arrived.messages == 3; });
  EXPECT_EQ(reception.refused, 2);
  EXPECT_EQ(reception.sequence.used, 1);
}

TEST_F(Udpm, AThrowingHandlerLeavesTheBusUsable) {
  Bus sender(url()), receiver(url());
  const Reception& reception = receiver.subscribe<odometry>("ODOMETRY", [](const odometry& m) {
    if (m.seq == 0) throw std::runtime_error("boom");
  });
  sender.publish("ODOMETRY", make_odometry(0));
  EXPECT_THROW(handle_until(receiver, [&] { return reception.arrived.messages == 1; }), std::runtime_error);
  sender.publish("ODOMETRY", make_odometry(1));
  handle_until(receiver, [&] { return reception.arrived.messages == 2; });
  EXPECT_EQ(reception.handler_errors, 1);
  EXPECT_EQ(reception.sequence.used, 2);
}

TEST_F(Udpm, AMirrorHearsAllThatIsPublishedInMemoryAndSaysNothing) {
  Bus memory, listener(url());
  memory.mirror_to(url());
  const Reception& inside = memory.subscribe<odometry>("ODOMETRY", [](const odometry&) {});
  const Reception& outside = listener.subscribe<odometry>("ODOMETRY", [](const odometry&) {});
  memory.publish("ODOMETRY", make_odometry(0));
  memory.drain();
  handle_until(listener, [&] { return outside.arrived.messages == 1; });
  EXPECT_EQ(outside.sequence.used, 1);

  listener.publish("ODOMETRY", make_odometry(1));
  handle_until(listener, [&] { return outside.arrived.messages == 2; });
  memory.drain();
  EXPECT_EQ(inside.arrived.messages, 1) << "one way";
}

TEST_F(Udpm, AMessageTooLargeForOneDatagramCanArriveInFragments) {
  Bus sender(url()), receiver(url());
  std::int32_t beams = 0;
  receiver.subscribe<ultrasonic_scan>("ULTRASONIC_SCAN", [&](const ultrasonic_scan& m) { beams = m.beam_count; });
  std::int64_t seq = 0;
  handle_until(receiver, [&] {  // again and again: one lost fragment loses the message
    if (beams == 0) sender.publish("ULTRASONIC_SCAN", make_scan(seq++, 4000));  // 130 kB
    return beams != 0;
  });
  EXPECT_EQ(beams, 4000);
}

/// One of LCM's own tools, running until it ends or this does.
class Tool {
 public:
  explicit Tool(std::vector<std::string> words) : process_(fork()) {
    if (process_ != 0) return;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ~Tool() { stop(); }
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  void stop() {
    if (process_ <= 0) return;
    kill(process_, SIGINT);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_;
};

class LcmTools : public Udpm {
 protected:
  void SetUp() override {
    Udpm::SetUp();
    if (!fs::exists("/usr/bin/lcm-logger")) GTEST_SKIP() << "no lcm-logger (liblcm-bin)";
  }
  ~LcmTools() override { fs::remove(log_); }

  fs::path log_ = fs::path(testing::TempDir()) / ("bus_udpm_" + std::to_string(getpid()) + ".lcmlog");
};

TEST_F(LcmTools, LogplayerPlaysWhatWeRecord) {
  {
    LogWriter writer(log_);
    for (std::int64_t seq = 0; seq < 50; ++seq) writer.write("ODOMETRY", 1000 * seq, bytes_of(make_odometry(seq)));
  }
  Bus receiver(url());
  const Reception& reception = receiver.subscribe<odometry>("ODOMETRY", [](const odometry&) {});
  Tool player({"lcm-logplayer", "--lcm-url=" + url(), log_.string()});
  handle_until(receiver, [&] { return reception.sequence.used == 50; });
  EXPECT_EQ(reception.sequence.used, 50);
  EXPECT_EQ(reception.refused, 0);
}

TEST_F(LcmTools, WeReadWhatLoggerRecords) {
  Bus sender(url());
  std::int64_t sent = 0;
  {
    Tool logger({"lcm-logger", "--quiet", "--flush-interval=10", "--lcm-url=" + url(), log_.string()});
    const auto recorded = [&] { return fs::exists(log_) && fs::file_size(log_) > 10000; };
    for (int i = 0; i < 6000 && !recorded(); ++i) {  // until the logger has started and written some
      sender.publish("ODOMETRY", make_odometry(sent++));
      std::this_thread::sleep_for(milliseconds(5));
    }
  }
  LogReader reader(log_);
  std::int64_t seq = -1, count = 0;
  while (const auto event = reader.next()) {
    EXPECT_EQ(event->channel, "ODOMETRY");
    const auto message = decode<odometry>(event->data);
    EXPECT_GT(message.seq, seq);
    seq = message.seq;
    ++count;
  }
  EXPECT_GT(count, 10);
  EXPECT_EQ(reader.truncated_bytes(), 0u);
}

}  // namespace
}  // namespace noctule::bus
