#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bus/codec.hpp"
#include "bus/sequence.hpp"

namespace noctule::bus {

struct Traffic {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
};

/// What one subscription has seen.
struct Reception {
  std::string channel;
  Traffic arrived;                  ///< all that came, good or bad
  SequenceCounts sequence;          ///< over all senders; `used` went to the handler
  std::int64_t refused = 0;         ///< not one message of the type
  std::int64_t handler_errors = 0;  ///< handed over, but the handler threw
  std::string last_error;
};

/// Receives problems that do not stop a bus: (channel, one line).
using ProblemHandler = std::function<void(const std::string&, const std::string&)>;

/// Sender of a message: where a channel is shared by modules the `module` it names, else "".
template <Message M>
[[nodiscard]] std::string_view sender_of(const M& message) {
  if constexpr (requires { message.module; }) return message.module;
  return {};
}

/// Guards one subscription: opens messages, counts, and keeps from the handler what it must not see.
class Inbox {
 public:
  explicit Inbox(std::string channel) { reception_.channel = std::move(channel); }

  /// The message in the bytes if the handler is to see it: exactly one message of the type, not seen before and not
  /// overtaken by a younger one of its sender. All else is counted; `problem` also hears of what is no such message.
  template <Message M>
  [[nodiscard]] std::optional<M> open(Bytes bytes, const ProblemHandler& problem) {
    count(bytes);
    std::optional<M> message;
    try {
      message = decode<M>(bytes);
      if (!admit(sender_of(*message), message->seq, message->utime)) message.reset();
    } catch (const InputError& error) {
      message.reset();
      refuse(error.what(), problem);
    }
    return message;
  }

  /// Counts a failure of the handler.
  void handler_failed(const std::string& what);

  [[nodiscard]] const Reception& reception() const { return reception_; }

 private:
  void count(Bytes bytes);
  /// \throws InputError when seq is negative
  [[nodiscard]] bool admit(std::string_view sender, std::int64_t seq, std::int64_t utime);
  void refuse(const std::string& what, const ProblemHandler& problem);

  Reception reception_;
  std::map<std::string, SequenceCounter, std::less<>> senders_;
};

}  // namespace noctule::bus
