#pragma once
/// What all modules share: input that is counted and guarded, output that is numbered, a status and timings.
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/channels.hpp"
#include "convert/convert.hpp"
#include "modules/latency.hpp"
#include "noctule/module_status.hpp"

namespace noctule::modules {

/// A module says once a second of message time, and whenever its state changes, how it fares (MODULE_STATUS) and what
/// it costs (TIMING). Input that the user could mend (InputError) is dropped, counted and reported, and the run goes
/// on; any other exception is a fault of the program: the module reports that it failed, and the bus rethrows it.
/// The bus must outlive the module, and must not be drained after the module is gone.
class Module {
 public:
  Module(bus::Bus& bus, std::string name);
  virtual ~Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Publishes what is still held back, then the last status. Does nothing the second time.
  void finish();
  [[nodiscard]] bool finished() const { return state_ == module_status::STATE_FINISHED; }

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Of all handlers since the start.
  [[nodiscard]] const LatencyHistogram& durations() const { return durations_; }
  [[nodiscard]] double cpu_seconds() const { return cpu_seconds_; }

 protected:
  /// Calls `handler` with the core value of each message of the channel.
  template <bus::Message M, class Handler>
  void listen(const std::string& channel, Handler handler) {
    listen_to_message<M>(channel, [handler = std::move(handler)](const M& m) { handler(convert::from_message(m)); });
  }
  /// Calls `handler` with each message of the channel as it is.
  template <bus::Message M, class Handler>
  void listen_to_message(const std::string& channel, Handler handler) {
    receptions_.push_back(&bus_.subscribe<M>(channel, [this, handler = std::move(handler)](const M& message) {
      guard(message.utime, [&] { handler(message); });
    }));
  }

  /// Finishes this module when all modules named have finished.
  void finish_after(std::set<std::string> modules);

  /// Calls `handler` with every status on the bus, this module's own included. Not counted among the input.
  void watch_modules(std::function<void(const module_status&)> handler) {
    bus_.subscribe<module_status>(bus::channel::kModuleStatus, std::move(handler));
  }

  /// Publishes a core value, or a message, under the next number of its channel.
  template <class Value>
  void publish(const std::string& channel, Value value) {
    if constexpr (bus::Message<Value>) {
      value.seq = next_seq_[channel]++;
      bus_.publish(channel, value);
    } else {
      value.stamp.seq = next_seq_[channel]++;
      bus_.publish(channel, convert::to_message(value));
    }
  }
  /// Publishes a core value, or a message, under the number it has.
  template <class Value>
  void publish_as_numbered(const std::string& channel, const Value& value) {
    if constexpr (bus::Message<Value>) {
      bus_.publish(channel, value);
    } else {
      bus_.publish(channel, convert::to_message(value));
    }
  }

  /// Publishes an encoded message as it is.
  void publish_bytes(const std::string& channel, std::int64_t utime, bus::Bytes bytes) {
    bus_.publish_bytes(channel, utime, bytes);
  }

  /// Runs a piece of the module's work: timed, its exceptions sorted as above.
  /// \param utime of the message that caused it [us]
  void guard(std::int64_t utime, const std::function<void()>& work);

  /// Counts a message that was in order but could not be used.
  void count_dropped(const std::string& why);
  /// One line for the user, shown in the status from now on.
  void warn(const std::string& text) { warning_ = text; }

  /// What is still held back is published here.
  virtual void on_finish() {}

 private:
  void run_timed(const std::function<void()>& work);
  void set_state(std::int8_t state);
  void report_if_due();
  void publish_status();
  void publish_timing();
  [[nodiscard]] module_status counted_status() const;

  bus::Bus& bus_;
  std::string name_;
  std::vector<const bus::Reception*> receptions_;
  std::map<std::string, std::int64_t> next_seq_;
  std::set<std::string> awaited_;  ///< modules that have not finished yet

  std::int8_t state_ = module_status::STATE_STARTING;
  std::int64_t utime_ = 0;         ///< of the latest message
  std::int64_t status_utime_ = 0;  ///< of the latest status
  std::int64_t dropped_ = 0;
  std::int64_t errors_ = 0;
  std::int64_t reported_problems_ = 0;  ///< in the latest status
  std::string last_error_;
  std::string warning_;

  LatencyHistogram durations_;
  LatencyHistogram window_;  ///< since the latest timing
  double cpu_seconds_ = 0.0;
  double window_cpu_ = 0.0;
  double window_begin_ = 0.0;  ///< [s] of the wall clock
};

}  // namespace noctule::modules
