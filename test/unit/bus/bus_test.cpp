#include "bus/bus.hpp"

#include <gtest/gtest.h>
#include <sys/time.h>

#include <algorithm>
#include <csignal>

#include "unit/bus/messages.hpp"

namespace noctule::bus {
namespace {

TEST(Bus, DeliversInOrderAndDrainsWhatHandlersPublish) {
  Bus bus;
  std::vector<std::int64_t> scans, echoes;
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry& m) {
    scans.push_back(m.seq);
    bus.publish("ULTRASONIC_SCAN", make_scan(m.seq, 60));
  });
  bus.subscribe<ultrasonic_scan>("ULTRASONIC_SCAN", [&](const ultrasonic_scan& m) { echoes.push_back(m.seq); });
  for (std::int64_t seq = 0; seq < 500; ++seq) bus.publish("ODOMETRY", make_odometry(seq));
  EXPECT_EQ(bus.drain(), 1000);
  ASSERT_EQ(scans.size(), 500u);
  EXPECT_TRUE(std::ranges::is_sorted(scans));
  EXPECT_EQ(echoes, scans);
}

TEST(Bus, KeepsChannelsOfACommonPrefixApart) {
  Bus bus;
  int heard = 0;
  bus.subscribe<odometry>("MAP", [&](const odometry&) { ++heard; });
  bus.publish("MAP_KNOWN_POSE", make_odometry(0));
  bus.publish("MY_MAP", make_odometry(0));
  bus.drain();
  EXPECT_EQ(heard, 0);
}

TEST(Bus, RethrowsTheFirstErrorOnceAllElseIsHandled) {
  Bus bus;
  int handled = 0;
  const Reception& reception = bus.subscribe<odometry>("ODOMETRY", [&](const odometry& m) {
    if (m.seq == 1) throw InputError("first");
    if (m.seq == 2) throw std::logic_error("second");
    ++handled;
  });
  for (std::int64_t seq = 0; seq < 5; ++seq) bus.publish("ODOMETRY", make_odometry(seq));
  try {
    bus.drain();
    FAIL() << "expected an exception";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "first");
  }
  EXPECT_EQ(handled, 3);
  EXPECT_EQ(reception.handler_errors, 2);
  EXPECT_EQ(reception.last_error, "second");

  bus.publish("ODOMETRY", make_odometry(5));
  EXPECT_EQ(bus.drain(), 1) << "the bus is as good as new";
  EXPECT_EQ(handled, 4);
}

TEST(Bus, AHandlerMustNotDrain) {
  Bus bus;
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry&) { bus.drain(); });
  bus.publish("ODOMETRY", make_odometry(0));
  EXPECT_THROW(bus.drain(), std::logic_error);
}

TEST(Bus, RefusesBytesThatAreNoMessageAndNamesTheChannel) {
  Bus bus;
  std::vector<std::string> problems;
  bus.on_problem(
      [&](const std::string& channel, const std::string& what) { problems.push_back(channel + ": " + what); });
  int heard = 0;
  const Reception& reception = bus.subscribe<odometry>("ODOMETRY", [&](const odometry&) { ++heard; });

  const auto intact = bytes_of(make_odometry(0));
  auto trailing = intact;
  trailing.push_back(0);
  auto hash = intact;
  hash[3] ^= 1;
  auto negative = make_odometry(0);
  negative.seq = -7;
  bus.publish_bytes("ODOMETRY", 0, Bytes(intact).first(30));
  bus.publish_bytes("ODOMETRY", 0, trailing);
  bus.publish_bytes("ODOMETRY", 0, hash);
  bus.publish_bytes("ODOMETRY", 0, {});
  bus.publish("ODOMETRY", negative);
  bus.publish_bytes("ODOMETRY", 0, intact);
  bus.drain();

  EXPECT_EQ(heard, 1);
  EXPECT_EQ(reception.refused, 5);
  EXPECT_EQ(reception.sequence.used, 1);
  EXPECT_EQ(reception.arrived.messages, 6);
  ASSERT_EQ(problems.size(), 5u);
  EXPECT_NE(problems[0].find("ODOMETRY: expected a message of type odometry"), std::string::npos) << problems[0];
  EXPECT_EQ(problems[4], "ODOMETRY: seq: expected a number >= 0, got -7");
}

TEST(Bus, HandlesEachNumberOnceAndNoneLate) {
  Bus bus;
  std::vector<std::int64_t> used;
  const Reception& reception = bus.subscribe<odometry>("ODOMETRY", [&](const odometry& m) { used.push_back(m.seq); });
  for (const std::int64_t seq : {0, 1, 1, 4, 3, 5, 0}) bus.publish("ODOMETRY", make_odometry(seq));
  bus.drain();
  EXPECT_EQ(used, (std::vector<std::int64_t>{0, 1, 4, 5}));
  EXPECT_EQ(reception.sequence.missed, 2);
  EXPECT_EQ(reception.sequence.duplicates, 2);
  EXPECT_EQ(reception.sequence.late, 1);
}

TEST(Bus, EverySubscriberHearsEveryMessage) {
  Bus bus;
  int first = 0, second = 0;
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry&) { ++first; });
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry&) { ++second; });
  for (std::int64_t seq = 0; seq < 3; ++seq) bus.publish("ODOMETRY", make_odometry(seq));
  bus.drain();
  EXPECT_EQ(first, 3);
  EXPECT_EQ(second, 3);
}

TEST(Bus, CountsEachModuleOfASharedChannelOnItsOwn) {
  Bus bus;
  const Reception& reception = bus.subscribe<module_status>("MODULE_STATUS", [](const module_status&) {});
  module_status m{};
  for (std::int64_t seq = 0; seq < 3; ++seq)
    for (const char* module : {"slam", "mapper"}) {
      m.seq = seq;
      m.module = module;
      bus.publish("MODULE_STATUS", m);
    }
  bus.drain();
  EXPECT_EQ(reception.sequence.used, 6);
  EXPECT_EQ(reception.sequence.missed + reception.sequence.duplicates + reception.sequence.late, 0);
}

TEST(Bus, CountsTrafficByChannel) {
  Bus bus;
  for (std::int64_t seq = 0; seq < 3; ++seq) bus.publish("ODOMETRY", make_odometry(seq));
  bus.publish("ULTRASONIC_SCAN", make_scan(0, 60));
  ASSERT_EQ(bus.published().size(), 2u);
  EXPECT_EQ(bus.published().at("ODOMETRY").messages, 3);
  EXPECT_EQ(bus.published().at("ODOMETRY").bytes, 3 * static_cast<std::int64_t>(bytes_of(make_odometry(0)).size()));
  EXPECT_EQ(bus.published().at("ULTRASONIC_SCAN").messages, 1);
}

TEST(Bus, RefusesChannelNamesThatLcmWouldMisunderstand) {
  Bus bus;
  const auto publish = [&](const std::string& channel) { bus.publish(channel, make_odometry(0)); };
  for (const std::string channel : {"", "A.*", "A B", "A\n"}) EXPECT_THROW(publish(channel), InputError) << channel;
  EXPECT_THROW(publish(std::string(64, 'A')), InputError);
  EXPECT_NO_THROW(publish(std::string(63, 'A')));
  EXPECT_THROW(bus.subscribe<odometry>(".*", [](const odometry&) {}), InputError);
}

TEST(Bus, WaitsNoLongerThanAsked) {
  Bus bus;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(bus.handle_for(std::chrono::milliseconds(20)), 0);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(15));
}

TEST(Bus, ASignalEndsTheWait) {
  Bus bus;
  struct sigaction quiet {
  }, before{};
  quiet.sa_handler = [](int) {};
  sigaction(SIGALRM, &quiet, &before);
  const itimerval soon{{0, 20000}, {0, 20000}};  // again and again: the first may come before the wait
  setitimer(ITIMER_REAL, &soon, nullptr);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(bus.handle_for(std::chrono::seconds(60)), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  const itimerval never{};
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
}

TEST(Bus, ABusyChannelCannotHoldHandleForBeyondItsTime) {
  Bus bus;
  std::int64_t seq = 0;
  bus.subscribe<odometry>("ODOMETRY", [&](const odometry& m) { bus.publish("ODOMETRY", make_odometry(m.seq + 1)); });
  bus.publish("ODOMETRY", make_odometry(seq));
  EXPECT_GT(bus.handle_for(std::chrono::milliseconds(20)), 1);
}

TEST(Bus, AMirrorInMemoryMakesNoSense) {
  Bus bus;
  EXPECT_THROW(bus.mirror_to("memq://"), InputError);
}

}  // namespace
}  // namespace noctule::bus
