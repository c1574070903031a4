#include "datasets/victoria_park.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>

#include "datasets/zip_member.hpp"
#include "files.hpp"

namespace noctule::datasets {
namespace {

template <class T>
std::string bytes(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}

std::string element(std::uint32_t type, const std::string& data) {
  return bytes(type) + bytes(static_cast<std::uint32_t>(data.size())) + data +
         std::string((8 - data.size() % 8) % 8, '\0');
}

template <class T>
std::string array(const std::string& name, std::uint32_t type, const std::vector<T>& values) {
  std::string data;
  for (const T v : values) data += bytes(v);
  const std::string flags = element(6, bytes(std::uint32_t{6}) + bytes(std::uint32_t{0}));
  const std::string size = element(5, bytes(static_cast<std::int32_t>(values.size())) + bytes(std::int32_t{1}));
  return element(14, flags + size + element(1, name) + element(type, data));
}

std::string mat(const std::string& arrays) {
  std::string header = "MATLAB 5.0 MAT-file, by a test";
  header.resize(124, ' ');
  return header + bytes(std::uint16_t{0x0100}) + "IM" + arrays;
}

/// An archive of one file.
std::string zip(const std::string& name, const std::string& content, bool deflated) {
  std::string packed = content;
  if (deflated) {
    packed.resize(content.size() + 100);
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
  }
  const auto crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
  const auto u16 = [](std::size_t v) { return bytes(static_cast<std::uint16_t>(v)); };
  const auto u32 = [](std::size_t v) { return bytes(static_cast<std::uint32_t>(v)); };
  const std::string common = u16(20) + u16(0) + u16(deflated ? 8 : 0) + u32(0) + u32(crc) + u32(packed.size()) +
                             u32(content.size()) + u16(name.size()) + u16(0);
  const std::string local = "PK\3\4" + common + name + packed;
  const std::string entry = "PK\1\2" + u16(20) + common + u16(0) + u16(0) + u16(0) + u32(0) + u32(0) + name;
  return local + entry + "PK\5\6" + u16(0) + u16(0) + u16(1) + u16(1) + u32(entry.size()) + u32(local.size()) + u16(0);
}

TEST(ZipMember, IsUnpackedWholeOrRefused) {
  const TemporaryFolder folder;
  const std::string content(5000, 'x');
  for (const bool deflated : {false, true}) {
    const std::string archive = zip("a/b.txt", content, deflated);
    EXPECT_EQ(read_zip_member(folder.write("a.zip", archive), "a/b.txt"), content);
    EXPECT_NE(refusal([&] { static_cast<void>(read_zip_member(folder.path() / "a.zip", "c")); }).find("a member c"),
              std::string::npos);
    for (std::size_t cut = 0; cut < archive.size(); cut += 7) {  // never read beyond the end
      const auto path = folder.write("cut.zip", archive.substr(0, cut));
      EXPECT_THROW(static_cast<void>(read_zip_member(path, "a/b.txt")), InputError) << cut;
    }
    if (!deflated) continue;
    std::string damaged = archive;
    damaged[45] = static_cast<char>(damaged[45] ^ 1);
    EXPECT_THROW(static_cast<void>(read_zip_member(folder.write("bad.zip", damaged), "a/b.txt")), InputError);
  }
}

class VictoriaParkTest : public testing::Test {
 protected:
  /// Straight on along x for 60 s at 1 m/s, from t = 10 s on; fixes twice a second, x east 100 + way, y north 50.
  VictoriaParkTest() {
    std::vector<std::uint32_t> time;
    std::vector<double> speed, steering;
    for (std::uint32_t t = 10'000; t <= 70'000; t += 100) {
      time.push_back(t);
      speed.push_back(1.0);
      steering.push_back(0.0);
    }
    folder_.write("aa3_dr.mat",
                  mat(array("time", 6, time) + array("speed", 9, speed) + array("steering", 9, steering)));
    std::vector<std::uint32_t> gps_time;
    std::vector<double> east, north;
    for (std::uint32_t t = 8'000; t <= 70'000; t += 500) {
      const bool jumped = t >= 30'000 && t < 36'000;  // 12 fixes that agree with each other
      gps_time.push_back(t);
      east.push_back(100.0 + 1e-3 * t + (jumped ? 30.0 : 0.0));
      north.push_back(50.0);
    }
    folder_.write("aa3_gpsx.mat",
                  mat(array("timeGps", 6, gps_time) + array("Lo_m", 9, east) + array("La_m", 9, north)));
    // One tree straight ahead of the scanner, in three scans, one long line; times since the first fix.
    std::string laser;
    for (const char* t : {"2.5", "3.5", "90"}) {
      laser += t;
      for (int i = 0; i < 361; ++i) laser += std::abs(i - 180) <= 1 ? "\t10.00" : "\t81.91";
      laser += '\t';
    }
    folder_.write("victoria_park_ascii.zip", zip("LASER.txt", laser, true));
    folder_.write("lasersampling.txt", "12000\n13000\n");
    const std::string empty = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";
    folder_.write("ObservationDistance.txt", "20 5" + empty + "0 0" + empty);
    folder_.write("ObservationAngle.txt", "1.5707963267948966 0.5707963267948966" + empty + "0 0" + empty);
  }
  VictoriaParkParameters parameters() const {
    VictoriaParkParameters p;
    p.path = folder_.path();
    return p;
  }
  TemporaryFolder folder_;
};

TEST_F(VictoriaParkTest, YieldsOdometryAndTreesAtTheTimesOfTheScans) {
  VictoriaPark source(parameters());
  const auto observations = all(source);
  const auto scans = only<LandmarkDetections>(observations);
  ASSERT_EQ(scans.size(), 2u);  // the third is after the last odometry
  EXPECT_EQ(scans[0].stamp, (Stamp{10'500'000, 0}));
  ASSERT_EQ(scans[0].detections.size(), 1u);
  EXPECT_NEAR(scans[0].detections[0].bearing, 0.0, 1e-12);
  EXPECT_NEAR(scans[0].detections[0].range, 10.1, 0.1);
  EXPECT_EQ(scans[0].sensor_in_base, (Pose2{3.78, 0.5, 0.0}));
  const auto odometry = only<Odometry>(observations);
  Pose2 pose;
  for (const Odometry& o : odometry) pose = pose * o.increment;
  EXPECT_NEAR(pose.x, 60.0, 1e-9);
  EXPECT_NEAR(pose.y, 0.0, 1e-9);
  EXPECT_TRUE(only<GroundTruth>(observations).empty());
}

TEST_F(VictoriaParkTest, FixesThatJumpAreNotBelievedHoweverLongTheyStayAway) {
  VictoriaPark source(parameters());
  const auto& fixes = source.world().fixes;
  ASSERT_EQ(fixes.size(), 121u - 12u);
  for (const KnownPosition& f : fixes) {
    EXPECT_NEAR(f.position.x(), 100.0 + 1e-6 * static_cast<double>(f.utime), 1e-9);
  }
  const Pose2 start = source.world().start_in_map;
  EXPECT_NEAR(start.x, 110.0, 1e-6);
  EXPECT_NEAR(start.y, 50.0, 1e-6);
  EXPECT_NEAR(start.yaw, 0.0, 1e-9);
}

TEST_F(VictoriaParkTest, TakesTheTreesThatOthersExtracted) {
  VictoriaParkParameters p = parameters();
  p.trees = Trees::extracted;
  VictoriaPark source(p);
  const auto scans = only<LandmarkDetections>(all(source));
  ASSERT_EQ(scans.size(), 1u);  // the second is empty
  ASSERT_EQ(scans[0].detections.size(), 2u);
  EXPECT_EQ(scans[0].detections[0].range, 20.0);
  EXPECT_NEAR(scans[0].detections[0].bearing, 0.0, 1e-12);
  EXPECT_NEAR(scans[0].detections[1].bearing, -1.0, 1e-12);  // to the right
}

TEST_F(VictoriaParkTest, RefusesWhatIsMissingOrDamaged) {
  const auto refused = [&] { return refusal([&] { VictoriaPark source(parameters()); }); };
  const std::string whole = [&] {
    std::ifstream in(folder_.path() / "aa3_dr.mat", std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  }();
  for (const std::size_t cut : {0u, 50u, 130u, 200u, 3000u}) {
    folder_.write("aa3_dr.mat", whole.substr(0, cut));
    EXPECT_NE(refused().find("aa3_dr.mat"), std::string::npos) << cut;
  }
  folder_.write("aa3_dr.mat", mat(array<double>("time", 9, {1, 2}) + array<double>("speed", 9, {1, NAN}) +
                                  array<double>("steering", 9, {0, 0})));
  EXPECT_NE(refused().find("speed: finite numbers"), std::string::npos);
  folder_.write("aa3_dr.mat", mat(array<double>("time", 9, {2, 1}) + array<double>("speed", 9, {1, 1}) +
                                  array<double>("steering", 9, {0, 0})));
  EXPECT_NE(refused().find("rising times"), std::string::npos);
  folder_.write("aa3_dr.mat", whole);
  std::filesystem::remove(folder_.path() / "victoria_park_ascii.zip");
  EXPECT_NE(refused().find("LASER.txt"), std::string::npos);
  VictoriaParkParameters nowhere;
  nowhere.path = folder_.path() / "nowhere";
  EXPECT_NE(refusal([&] { VictoriaPark source(nowhere); }).find("expected the folder"), std::string::npos);
}

TEST(VictoriaParkRecording, HasTheStatedSize) {
  NOCTULE_RECORDED(folder, "victoria-park");
  VictoriaParkParameters p;
  p.path = folder;
  VictoriaPark source(p);
  const auto observations = all(source);
  double way = 0.0;
  for (const Odometry& o : only<Odometry>(observations)) way += o.increment.position().norm();
  EXPECT_NEAR(way, 4030.0, 30.0);
  EXPECT_NEAR(static_cast<double>(source.world().fixes.size()), 4150.0, 60.0);
  const auto scans = only<LandmarkDetections>(observations);
  std::size_t trees = 0;
  for (const LandmarkDetections& s : scans) trees += s.detections.size();
  EXPECT_GT(scans.size(), 6500u);
  EXPECT_GT(static_cast<double>(trees) / static_cast<double>(scans.size()), 4.0);
}

}  // namespace
}  // namespace noctule::datasets
