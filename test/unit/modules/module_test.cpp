/// What every module does: counts, refusals, states, last words.
#include "modules/module.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.hpp"
#include "heard.hpp"
#include "noctule/odometry.hpp"
#include "noctule/timing.hpp"

namespace noctule::modules {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

Odometry motion(std::int64_t seq, std::int64_t utime) {
  Odometry o;
  o.stamp = {utime, seq};
  o.increment.x = 0.1;
  return o;
}

/// Repeats odometry; some seq are troublesome.
class Echoing : public Module {
 public:
  explicit Echoing(bus::Bus& bus) : Module(bus, "echoing") {
    listen<odometry>("ODOMETRY", [this](const Odometry& o) {
      if (o.stamp.seq == bad_input) throw InputError("refused on purpose");
      if (o.stamp.seq == fault) throw std::logic_error("a fault on purpose");
      publish("ECHO", o);
    });
    finish_after({"source"});
  }
  std::int64_t bad_input = -1;
  std::int64_t fault = -1;

 private:
  void on_finish() override { publish("ECHO", motion(0, 77)); }
};

class ModuleTest : public ::testing::Test {
 protected:
  void send(std::int64_t seq, std::int64_t utime) {
    bus_.publish("ODOMETRY", convert::to_message(motion(seq, utime)));
    bus_.drain();
  }
  void source_says(std::int8_t state) {
    module_status status{};
    status.module = "source";
    status.state = state;
    status.seq = next_source_status_++;
    bus_.publish("MODULE_STATUS", status);
    bus_.drain();
  }
  module_status latest() {
    for (auto status = statuses_.all.rbegin(); status != statuses_.all.rend(); ++status) {
      if (status->module == "echoing") return *status;
    }
    return {};
  }

  bus::Bus bus_;
  Heard<odometry> echoes_{bus_, "ECHO"};
  Heard<module_status> statuses_{bus_, "MODULE_STATUS"};
  Heard<timing> timings_{bus_, "TIMING"};
  Echoing module_{bus_};
  std::int64_t next_source_status_ = 0;
};

TEST_F(ModuleTest, NumbersWhatItPublishesFromZero) {
  for (const std::int64_t seq : {40, 41, 42}) send(seq, seq);
  ASSERT_EQ(echoes_.all.size(), 3u);
  for (std::int64_t i = 0; i < 3; ++i) EXPECT_EQ(echoes_.all[static_cast<std::size_t>(i)].seq, i);
}

TEST_F(ModuleTest, SaysThatItRunsAtTheFirstMessageAndThenOnceASecond) {
  send(0, 0);
  ASSERT_EQ(statuses_.all.size(), 1u);
  EXPECT_EQ(latest().state, module_status::STATE_RUNNING);
  for (int i = 1; i <= 50; ++i) send(i, i * kSecond / 10);
  EXPECT_EQ(statuses_.all.size(), 6u);
  EXPECT_EQ(timings_.all.size(), 6u);
  EXPECT_EQ(latest().received, 51);
  EXPECT_EQ(latest().utime, 5 * kSecond);
}

TEST_F(ModuleTest, CountsGapsDuplicatesAndLatecomers) {
  for (const std::int64_t seq : {0, 1, 5, 5, 3}) send(seq, seq);
  send(6, 2 * kSecond);
  EXPECT_EQ(latest().received, 4);
  EXPECT_EQ(latest().missed, 3);
  EXPECT_EQ(latest().duplicates, 1);
  EXPECT_EQ(latest().late, 1);
  EXPECT_EQ(latest().state, module_status::STATE_DEGRADED);
  send(7, 4 * kSecond);
  EXPECT_EQ(latest().state, module_status::STATE_RUNNING) << "nothing new went wrong";
  EXPECT_EQ(echoes_.all.size(), 5u);
}

TEST_F(ModuleTest, BadInputIsDroppedCountedAndReported) {
  module_.bad_input = 1;
  for (const std::int64_t seq : {0, 1, 2}) EXPECT_NO_THROW(send(seq, seq));
  odometry not_finite = convert::to_message(motion(3, 3));
  not_finite.dx_m = std::numeric_limits<double>::quiet_NaN();
  bus_.publish("ODOMETRY", not_finite);
  bus_.publish_bytes("ODOMETRY", 4, std::vector<std::uint8_t>{1, 2, 3});
  EXPECT_NO_THROW(bus_.drain());
  send(4, 2 * kSecond);
  EXPECT_EQ(echoes_.all.size(), 3u);
  EXPECT_EQ(latest().errors, 3);
  EXPECT_EQ(latest().state, module_status::STATE_DEGRADED);
  EXPECT_NE(latest().last_error.find("dx_m"), std::string::npos) << latest().last_error;
}

TEST_F(ModuleTest, AFaultOfTheProgramStopsTheRun) {
  module_.fault = 1;
  send(0, 0);
  EXPECT_THROW(send(1, 1), std::logic_error);
  bus_.drain();
  EXPECT_EQ(latest().state, module_status::STATE_FAILED);
  EXPECT_EQ(latest().last_error, "a fault on purpose");
}

TEST_F(ModuleTest, FinishesOnceAfterThoseItWaitsFor) {
  send(0, 0);
  source_says(module_status::STATE_RUNNING);
  EXPECT_FALSE(module_.finished());
  source_says(module_status::STATE_FINISHED);
  EXPECT_TRUE(module_.finished());
  EXPECT_EQ(latest().state, module_status::STATE_FINISHED);
  ASSERT_EQ(echoes_.all.size(), 2u);
  EXPECT_EQ(echoes_.all.back().utime, 77) << "its last words";

  module_.finish();
  send(1, 1);
  EXPECT_EQ(echoes_.all.size(), 2u) << "nothing after the last words";
}

}  // namespace
}  // namespace noctule::modules
