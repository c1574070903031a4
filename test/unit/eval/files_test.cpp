/// What is read from users' files, and how it is refused.
#include <gtest/gtest.h>

#include <functional>

#include "core/error.hpp"
#include "eval/landmark_file.hpp"
#include "eval/tum.hpp"

namespace noctule::eval {
namespace {

void expect_refusal(const std::function<void()>& action, const std::string& message) {
  try {
    action();
    FAIL() << "not refused: " << message;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), message);
  }
}

TEST(ParseTum, ReadsWhatIsWritten) {
  const std::vector<TimedPose> trajectory{{5, {1e-300, 12345.678901234567, -3}},
                                          {1'600'000'123'456, {0.1, -1.0 / 3, 2.9}}};
  const auto read = parse_tum(to_tum(trajectory), "a.tum");
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].utime, trajectory[i].utime);
    EXPECT_LT(difference(in_plane(read[i].pose), trajectory[i].pose).norm(), 1e-12);
  }
}

TEST(ParseTum, CommentsBlanksAndExponents) {
  const auto read = parse_tum("# stamp x y z ...\r\n\n  1.5e+00\t1 2  3 0 0 0.6 -0.8 \r\n", "a.tum");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].utime, 1'500'000);
  EXPECT_EQ(read[0].pose.position, Vector3(1, 2, 3));
  EXPECT_NEAR(read[0].pose.rotation.z(), 0.6, 1e-15);
  EXPECT_NEAR(read[0].pose.rotation.w(), -0.8, 1e-15);
}

TEST(ParseTum, Refusals) {
  const auto parse = [](const char* text) { return [text] { (void)parse_tum(text, "a.tum"); }; };
  expect_refusal(parse("0 1 2 3 0 0 0\n"), "a.tum:1: expected 8 numbers, got 7");
  expect_refusal(parse("# x\n0 1 2 x 0 0 0 1\n"), "a.tum:2: expected tz as a finite number, got 'x'");
  expect_refusal(parse("0 1 2 nan 0 0 0 1\n"), "a.tum:1: expected tz as a finite number, got 'nan'");
  expect_refusal(parse("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1"), "a.tum:2: expected a timestamp after 1.000000, got 1");
  expect_refusal(parse("1 0 0 0 0 0 0 2\n"), "a.tum:1: expected a quaternion of length 1, got length 2");
  expect_refusal(parse("1e300 0 0 0 0 0 0 1\n"), "a.tum:1: expected a timestamp in seconds, got 1e+300");
  expect_refusal(parse(""), "a.tum: expected poses, got none");
}

TEST(ParseLandmarks, WithAndWithoutHeader) {
  for (const char* text : {"id,x,y\n7,1.5,-2\n-1, 0 ,3e1\n", "7,1.5,-2\n-1,0,30"}) {
    const auto landmarks = parse_landmarks(text, "map.csv");
    ASSERT_EQ(landmarks.size(), 2u);
    EXPECT_EQ(landmarks[0].id, 7);
    EXPECT_EQ(landmarks[0].position, Vector2(1.5, -2));
    EXPECT_EQ(landmarks[1].id, -1);
    EXPECT_EQ(landmarks[1].position, Vector2(0, 30));
  }
  EXPECT_TRUE(parse_landmarks("id,x,y\n", "map.csv").empty());
}

TEST(ParseLandmarks, Refusals) {
  const auto parse = [](const char* text) { return [text] { (void)parse_landmarks(text, "map.csv"); }; };
  expect_refusal(parse("id,x,y\n1,2\n"), "map.csv:2: expected 3 numbers, got 2");
  expect_refusal(parse("1.5,2,3\n"), "map.csv:1: expected an integer id, got 1.5");
  expect_refusal(parse("1,2,3\n2,0,0\n1,2,3\n"), "map.csv:3: expected each id once, got 1 as in line 1");
  expect_refusal(parse("1,,3\n"), "map.csv:1: expected x as a finite number, got ''");
  expect_refusal(parse("1,2,3\nid,x,y\n"), "map.csv:2: expected id as a finite number, got 'id'");
}

}  // namespace
}  // namespace noctule::eval
