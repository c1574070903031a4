#include "bus/sequence.hpp"

#include <gtest/gtest.h>

namespace noctule::bus {
namespace {

/// A sender whose message number n was measured at 1000 n.
Arrival arrive(SequenceCounter& counter, std::int64_t seq) {
  return counter.arrive(seq, 1000 * seq);
}

TEST(SequenceCounter, AnUnbrokenSequenceFromAnywhereIsFresh) {
  SequenceCounter counter;
  for (std::int64_t seq = 17; seq < 300; ++seq) EXPECT_EQ(arrive(counter, seq), Arrival::fresh);
  EXPECT_EQ(counter.counts().used, 283);
  EXPECT_EQ(counter.counts().missed, 0);
}

TEST(SequenceCounter, GapsCountTheNumbersLeftOut) {
  SequenceCounter counter;
  for (const std::int64_t seq : {0, 1, 4, 5, 105}) EXPECT_EQ(arrive(counter, seq), Arrival::fresh);
  EXPECT_EQ(counter.counts().missed, 2 + 99);
}

TEST(SequenceCounter, TellsDuplicatesFromLatecomers) {
  SequenceCounter counter;
  for (const std::int64_t seq : {0, 1, 2, 5}) arrive(counter, seq);
  EXPECT_EQ(arrive(counter, 5), Arrival::duplicate);
  EXPECT_EQ(arrive(counter, 2), Arrival::duplicate);
  EXPECT_EQ(arrive(counter, 4), Arrival::late);
  EXPECT_EQ(arrive(counter, 4), Arrival::duplicate);
  EXPECT_EQ(arrive(counter, 6), Arrival::fresh);
  EXPECT_EQ(arrive(counter, 3), Arrival::late);
  EXPECT_EQ(counter.counts().used, 5);
  EXPECT_EQ(counter.counts().missed, 2);
  EXPECT_EQ(counter.counts().duplicates, 3);
  EXPECT_EQ(counter.counts().late, 2);
}

TEST(SequenceCounter, ForgetsDuplicatesLongerAgoThanItsWindowButNeverUsesThem) {
  SequenceCounter counter;
  for (std::int64_t seq = 0; seq <= 200; ++seq) arrive(counter, seq);
  EXPECT_EQ(arrive(counter, 200 - 63), Arrival::duplicate);
  EXPECT_EQ(arrive(counter, 200 - 64), Arrival::late);
}

TEST(SequenceCounter, ASenderThatStartsOverIsHeardAgain) {
  SequenceCounter counter;
  for (std::int64_t seq = 0; seq < 10; ++seq) arrive(counter, seq);
  EXPECT_EQ(counter.arrive(0, 20000), Arrival::restarted);
  EXPECT_EQ(counter.arrive(1, 21000), Arrival::fresh);
  EXPECT_EQ(counter.arrive(0, 20000), Arrival::duplicate);
  EXPECT_EQ(counter.counts().restarts, 1);
  EXPECT_EQ(counter.counts().missed, 0);
}

TEST(SequenceCounter, EqualTimesAreNoRestart) {
  SequenceCounter counter;
  EXPECT_EQ(counter.arrive(0, 5), Arrival::fresh);
  EXPECT_EQ(counter.arrive(1, 5), Arrival::fresh);
  EXPECT_EQ(counter.arrive(0, 5), Arrival::duplicate);
}

TEST(SequenceCounter, ANumberFromCorruptBytesDoesNotDeafenForEver) {
  SequenceCounter counter;
  arrive(counter, 1);
  EXPECT_EQ(counter.arrive(INT64_MAX, 1500), Arrival::fresh);
  EXPECT_EQ(arrive(counter, 2), Arrival::restarted);
  EXPECT_EQ(arrive(counter, 3), Arrival::fresh);
}

}  // namespace
}  // namespace noctule::bus
