#pragma once
/// Messages between modules. The only room that knows LCM.
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bus/codec.hpp"
#include "bus/inbox.hpp"
#include "bus/log.hpp"

namespace noctule::bus {

/// One LCM object. In one process all modules share one `memq://` bus: two of them do not hear each other. A message
/// that is published before anyone has subscribed is lost: construct all modules, then start the source. For one
/// thread.
class Bus {
 public:
  /// \param url `memq://`, or `udpm://GROUP:PORT?ttl=N` with ttl=0 where it is left out: nothing leaves this host
  /// \throws InputError for another URL, and where the host cannot multicast (with the command that mends it)
  explicit Bus(const std::string& url = "memq://");
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Sends a message. A datagram that the system does not take is counted and reported, not thrown: the receivers see
  /// a gap.
  /// \throws InputError when a string of the message holds a NUL
  template <Message M>
  void publish(const std::string& channel, const M& message) {
    encode(message, buffer_);
    publish_bytes(channel, message.utime, buffer_);
  }

  /// Sends an encoded message as it is, from a log for example. \param utime of the message [us]
  void publish_bytes(const std::string& channel, std::int64_t utime, Bytes bytes);

  /// Calls `handler` for each message of the channel that is whole and in order. Bytes that are no message of the type
  /// are refused, duplicates and latecomers dropped; all is counted.
  /// \returns the counts; they live as long as the bus
  /// \throws InputError where the bus cannot hear anything
  template <Message M>
  const Reception& subscribe(const std::string& channel, std::function<void(const M&)> handler) {
    return subscribe_bytes(channel, [this, handler = std::move(handler)](Bytes bytes, Inbox& inbox) {
      if (const std::optional<M> message = inbox.open<M>(bytes, problem_)) handler(*message);
    });
  }

  /// Handles all that has arrived, and what the handlers publish meanwhile, until nothing is left.
  /// \returns the number of messages handled
  /// \throws what the first handler threw, once all else is handled
  int drain();

  /// Waits at most `timeout` for a message, then handles all that has arrived, but starts none after `timeout`: a
  /// sender that is faster than the handlers cannot keep a module from its other duties.
  /// \returns the number of messages handled; 0 also when a signal ended the wait
  /// \throws as drain()
  int handle_for(std::chrono::milliseconds timeout);

  /// From now on publishes everything on a second, udpm bus too: one way, for lcm-spy, lcm-logger and the viewer.
  /// \throws InputError as the constructor, and for memq://
  void mirror_to(const std::string& url);

  /// From now on writes everything published here into the log, stamped with its own utime. Where the log takes no
  /// more (disk full) its InputError leaves publish(), or drain() when a handler published: no handler can hide it.
  void record_to(LogWriter log, std::set<std::string> except = {});

  /// Who hears of refused messages and failed datagrams. Nobody at first: they are only counted.
  void on_problem(ProblemHandler handler) { problem_ = std::move(handler); }

  /// What was published here, by channel.
  [[nodiscard]] const std::map<std::string, Traffic>& published() const { return published_; }
  /// Counts of all subscriptions, in the order in which they were made.
  [[nodiscard]] std::vector<Reception> receptions() const;
  /// Datagrams that the system did not take, mirror included.
  [[nodiscard]] std::int64_t failed_sends() const { return failed_sends_; }

 private:
  class Link;
  struct Subscription;
  using ByteHandler = std::function<void(Bytes, Inbox&)>;

  const Reception& subscribe_bytes(const std::string& channel, ByteHandler handler);
  void record(const std::string& channel, std::int64_t utime, Bytes bytes);
  void send(Link& link, const std::string& channel, Bytes bytes);
  int handle(int wait_ms, std::optional<std::chrono::steady_clock::time_point> deadline);

  std::unique_ptr<Link> link_;
  std::unique_ptr<Link> mirror_;
  std::optional<LogWriter> log_;
  std::set<std::string> not_logged_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::map<std::string, Traffic> published_;
  std::int64_t failed_sends_ = 0;
  ProblemHandler problem_;
  std::vector<std::uint8_t> buffer_;
  std::exception_ptr error_;  ///< the first one since drain() began
  bool handling_ = false;
};

}  // namespace noctule::bus
