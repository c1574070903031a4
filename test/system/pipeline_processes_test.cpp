/// The same modules as processes over UDP multicast: the same poses and walls as in one process.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "bus/url.hpp"
#include "noctule/contour_map.hpp"
#include "noctule/module_status.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"
#include "system/pipeline_setup.hpp"

namespace noctule::system_test {
namespace {

constexpr double kTolerance = 1e-6;  // m, rad

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

void expect_equal(const contour_map& a, const contour_map& b) {
  ASSERT_EQ(a.wall_count, b.wall_count);
  ASSERT_EQ(a.cylinder_count, b.cylinder_count);
  for (std::size_t i = 0; i < a.walls.size(); ++i) {
    EXPECT_NEAR(a.walls[i].rho_m, b.walls[i].rho_m, kTolerance);
    EXPECT_NEAR(a.walls[i].theta_rad, b.walls[i].theta_rad, kTolerance);
  }
  for (std::size_t i = 0; i < a.cylinders.size(); ++i) {
    EXPECT_NEAR(a.cylinders[i].x_m, b.cylinders[i].x_m, kTolerance);
    EXPECT_NEAR(a.cylinders[i].y_m, b.cylinders[i].y_m, kTolerance);
    EXPECT_NEAR(a.cylinders[i].radius_m, b.cylinders[i].radius_m, kTolerance);
  }
}

class PipelineProcesses : public ::testing::Test {
 protected:
  void SetUp() override {
    if (bus::probe_multicast(address_) != 0) GTEST_SKIP() << "no multicast on this host";
    const Outcome outcome = run(command("noctule-pipeline", short_run(), {"--out", (folder_ / "one").string()}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    log_ = folder_ / "one/run.lcmlog";
    bus_ = std::make_unique<bus::Bus>(url());
    bus_->subscribe<contour_map>("CONTOUR_MAP", [this](const contour_map& map) { map_ = map; });
    bus_->subscribe<path_estimate>("SLAM_PATH", [this](const path_estimate& path) { path_ = path; });
    bus_->subscribe<module_status>("MODULE_STATUS", [this](const module_status& s) { statuses_[s.module] = s; });
  }
  [[nodiscard]] std::string url() const { return bus::to_url(address_); }

  /// A module of the short run that listens on the bus.
  std::unique_ptr<Process> start(const std::string& app) {
    auto process = std::make_unique<Process>(command(app, short_run(), {"--bus", url()}));
    EXPECT_TRUE(process->says("listening")) << process->output();
    return process;
  }
  void handle_until_finished(const std::string& module) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (statuses_[module].state != module_status::STATE_FINISHED && std::chrono::steady_clock::now() < end) {
      bus_->handle_for(std::chrono::milliseconds(50));
    }
    EXPECT_EQ(statuses_[module].state, module_status::STATE_FINISHED) << module;
  }

  Folder folder_;
  fs::path log_;  ///< of the single process
  bus::UdpmAddress address_{.port = free_port()};
  std::unique_ptr<bus::Bus> bus_;
  contour_map map_{};
  path_estimate path_{};
  std::map<std::string, module_status> statuses_;
};

TEST_F(PipelineProcesses, AgreeWithTheSingleProcess) {
  const auto ultrasonic = start("noctule-ultrasonic"), slam = start("noctule-slam"), mapper = start("noctule-mapper");
  Process sim(command("noctule-sim", short_run(), {"--bus", url(), "--speed", "60"}));
  handle_until_finished("mapper");
  for (Process* process : {&sim, ultrasonic.get(), slam.get(), mapper.get()}) {
    const Outcome outcome = process->wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  }
  for (const auto& [module, status] : statuses_) {
    ASSERT_EQ(status.missed + status.dropped + status.errors, 0)
        << module << " did not hear everything, so that nothing can be compared: " << status.last_error;
  }
  const path_estimate path = messages_in<path_estimate>(log_, "SLAM_PATH").back();
  ASSERT_EQ(path_.pose_count, path.pose_count);
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    EXPECT_NEAR(path_.poses[i].x_m, path.poses[i].x_m, kTolerance);
    EXPECT_NEAR(path_.poses[i].y_m, path.poses[i].y_m, kTolerance);
    EXPECT_NEAR(path_.poses[i].yaw_rad, path.poses[i].yaw_rad, kTolerance);
  }
  expect_equal(map_, messages_in<contour_map>(log_, "CONTOUR_MAP").back());
}

TEST_F(PipelineProcesses, AReplayedLogGivesTheMapperItsMapAgain) {
  if (run({"lcm-logplayer", "--help"}).exit_code == 127) GTEST_SKIP() << "lcm-logplayer is not installed";
  const auto mapper = start("noctule-mapper");
  // Not the recorded maps: those heard come from the process.
  const Outcome player =
      run({"lcm-logplayer", "--lcm-url=" + url(), "--speed=60",
           "--regexp=ODOMETRY|ULTRASONIC_SCAN|SLAM_ESTIMATE|SLAM_PATH|MODULE_STATUS", log_.string()});
  EXPECT_EQ(player.exit_code, 0) << player.output;
  const Outcome outcome = mapper->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  while (bus_->handle_for(std::chrono::milliseconds(500)) > 0) continue;  // the log holds the mapper's last words too
  expect_equal(map_, messages_in<contour_map>(log_, "CONTOUR_MAP").back());
}

TEST_F(PipelineProcesses, ThePlayerPlaysEveryObservationOfALog) {
  std::int64_t heard = 0;
  bus_->subscribe<ultrasonic_scan>("ULTRASONIC_SCAN", [&](const ultrasonic_scan&) { ++heard; });
  const Process player(command("noctule-player", {log_.string(), "--bus", url(), "--speed", "200"}));
  handle_until_finished("source");
  EXPECT_EQ(heard, static_cast<std::int64_t>(messages_in<ultrasonic_scan>(log_, "ULTRASONIC_SCAN").size()));
}

TEST_F(PipelineProcesses, AModuleStopsAtCtrlCWithItsLastWords) {
  const auto mapper = start("noctule-mapper");
  mapper->send(SIGINT);
  handle_until_finished("mapper");
  EXPECT_EQ(mapper->wait().exit_code, 0);
}

}  // namespace
}  // namespace noctule::system_test
