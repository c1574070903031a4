#include "bus/sequence.hpp"

namespace noctule::bus {

Arrival SequenceCounter::arrive(std::int64_t seq, std::int64_t utime) {
  Arrival arrival = Arrival::fresh;
  if (newest_ < 0) {
    came_ = 1;
  } else if (seq > newest_) {
    const std::int64_t step = seq - newest_;
    counts_.missed += step - 1;
    came_ = step < 64 ? came_ << step | 1 : 1;
  } else if (utime > newest_utime_) {
    arrival = Arrival::restarted;
    ++counts_.restarts;
    came_ = 1;
  } else {
    return count_unused(seq);
  }
  newest_ = seq;
  newest_utime_ = utime;
  ++counts_.used;
  return arrival;
}

Arrival SequenceCounter::count_unused(std::int64_t seq) {
  const std::int64_t age = newest_ - seq;
  const std::uint64_t bit = age < 64 ? std::uint64_t{1} << age : 0;  // longer ago: taken as late
  if ((came_ & bit) != 0) {
    ++counts_.duplicates;
    return Arrival::duplicate;
  }
  came_ |= bit;
  ++counts_.late;
  return Arrival::late;
}

}  // namespace noctule::bus
