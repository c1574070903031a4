#pragma once
#include <cstdint>

namespace noctule::bus {

/// How a message stands to those that came before it on its channel.
enum class Arrival {
  fresh,      ///< younger than all before: to be used
  restarted,  ///< the sender began a new count (an older number with a younger time): to be used
  duplicate,  ///< came before: not to be used again
  late        ///< overtaken by a younger one: not to be used
};

struct SequenceCounts {
  std::int64_t used = 0;        ///< fresh or restarted
  std::int64_t missed = 0;      ///< numbers left out between those used: never came, or came late
  std::int64_t duplicates = 0;  ///< not used
  std::int64_t late = 0;        ///< not used
  std::int64_t restarts = 0;
};

/// Watches the numbers of one sender on one channel, which count from 0 without gaps. A listener may begin anywhere.
class SequenceCounter {
 public:
  /// Judges and counts the next message.
  /// \param seq its number, >= 0
  /// \param utime when it was measured [us]; does not decrease with the number
  Arrival arrive(std::int64_t seq, std::int64_t utime);

  [[nodiscard]] const SequenceCounts& counts() const { return counts_; }

 private:
  Arrival count_unused(std::int64_t seq);

  SequenceCounts counts_;
  std::int64_t newest_ = -1;
  std::int64_t newest_utime_ = 0;
  std::uint64_t came_ = 0;  ///< bit i: newest_ - i came
};

}  // namespace noctule::bus
