#include "bus/codec.hpp"

#include <gtest/gtest.h>

#include "core/rng.hpp"
#include "unit/bus/messages.hpp"

namespace noctule::bus {
namespace {

template <Message M>
std::string refusal(Bytes bytes) {
  try {
    (void)decode<M>(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Codec, RoundTrip) {
  const auto bytes = bytes_of(make_scan(3, 7));
  EXPECT_EQ(bytes_of(decode<ultrasonic_scan>(bytes)), bytes);
}

TEST(Codec, RefusesEveryTruncation) {
  const auto bytes = bytes_of(make_scan(3, 7));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(refusal<ultrasonic_scan>(Bytes(bytes).first(size)), "accepted") << size << " bytes";
  EXPECT_EQ(refusal<ultrasonic_scan>(Bytes(bytes).first(5)), "expected a message of type ultrasonic_scan, got 5 bytes");
  EXPECT_EQ(refusal<ultrasonic_scan>(Bytes(bytes).first(50)),
            "expected a message of type ultrasonic_scan, got 50 bytes that are cut off or corrupt");
}

TEST(Codec, RefusesTrailingBytes) {
  auto bytes = bytes_of(make_odometry(3));
  bytes.push_back(0);
  EXPECT_EQ(refusal<odometry>(bytes), "expected a message of type odometry in " + std::to_string(bytes.size() - 1) +
                                          " bytes, got " + std::to_string(bytes.size()) + " bytes");
}

TEST(Codec, RefusesAnotherTypeAndSaysSo) {
  const std::string text = refusal<odometry>(bytes_of(make_scan(3, 7)));
  EXPECT_NE(text.find("another type or another version of it"), std::string::npos) << text;
}

TEST(Codec, RefusesStringsThatLcmCannotCarry) {
  odometry m = make_odometry(1);
  m.frame = std::string("a\0b", 3);
  EXPECT_THROW(bytes_of(m), InputError);
}

/// Corrupt counts and lengths must neither crash, nor read beyond the buffer (sanitizers), nor allocate gigabytes.
TEST(Codec, SurvivesCorruptBytes) {
  const auto intact = bytes_of(make_scan(3, 7));
  Rng rng(1, stream_id("codec"));
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    auto bytes = intact;
    const auto flips = 1 + rng.index(4);
    for (std::uint64_t k = 0; k < flips; ++k) bytes[8 + rng.index(60)] = static_cast<std::uint8_t>(rng());
    if (refusal<ultrasonic_scan>(bytes) == "accepted") ++accepted;
  }
  EXPECT_GT(accepted, 0) << "corrupt numbers are not the decoder's to judge";
}

TEST(Codec, RefusesCountsThatOverflow) {
  const auto intact = bytes_of(make_scan(3, 7));
  // hash, utime, seq, length and text of the frame, half angle, limits
  const std::size_t count_at = 8 + 8 + 8 + 4 + sizeof("base_link") + 3 * 8;
  for (const std::uint32_t count : {0x80000000u, 0xffffffffu, 0x7fffffffu, 0x20000000u, 1000u}) {
    auto bytes = intact;
    for (std::size_t i = 0; i < 4; ++i) bytes[count_at + i] = static_cast<std::uint8_t>(count >> (24 - 8 * i));
    EXPECT_NE(refusal<ultrasonic_scan>(bytes), "accepted") << count;
  }
}

}  // namespace
}  // namespace noctule::bus
