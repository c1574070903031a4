#include "modules/module.hpp"

#include <chrono>
#include <ctime>

#include "core/error.hpp"
#include "noctule/timing.hpp"

namespace noctule::modules {
namespace {

constexpr std::int64_t kStatusPeriod = 1'000'000;  // [us] of message time

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
/// Of all threads: what runs while a handler runs works for it.
double cpu_clock() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

Module::Module(bus::Bus& bus, std::string name) : bus_(bus), name_(std::move(name)), window_begin_(wall_clock()) {}

void Module::guard(std::int64_t utime, const std::function<void()>& work) {
  if (finished()) return;
  utime_ = std::max(utime_, utime);
  try {
    run_timed(work);
  } catch (const InputError& error) {
    ++errors_;
    last_error_ = error.what();
  } catch (const std::exception& error) {
    ++errors_;
    last_error_ = error.what();
    set_state(module_status::STATE_FAILED);
    throw;
  }
  report_if_due();
}

void Module::run_timed(const std::function<void()>& work) {
  const double wall = wall_clock(), cpu = cpu_clock();
  const auto stop = [&] {
    const double seconds = wall_clock() - wall, cpu_seconds = cpu_clock() - cpu;
    durations_.add(seconds);
    window_.add(seconds);
    cpu_seconds_ += cpu_seconds;
    window_cpu_ += cpu_seconds;
  };
  try {
    work();
  } catch (...) {
    stop();
    throw;
  }
  stop();
}

void Module::finish() {
  if (finished() || state_ == module_status::STATE_FAILED) return;
  guard(utime_, [this] { on_finish(); });
  set_state(module_status::STATE_FINISHED);
  publish_timing();
}

void Module::finish_after(std::set<std::string> modules) {
  awaited_ = std::move(modules);
  watch_modules([this](const module_status& status) {
    if (status.state != module_status::STATE_FINISHED || awaited_.erase(status.module) == 0) return;
    if (awaited_.empty()) finish();
  });
}

void Module::count_dropped(const std::string& why) {
  ++dropped_;
  last_error_ = why;
}

void Module::set_state(std::int8_t state) {
  state_ = state;
  publish_status();
}

void Module::report_if_due() {
  const bool due = utime_ - status_utime_ >= kStatusPeriod;
  if (state_ != module_status::STATE_STARTING && !due) return;
  const module_status counts = counted_status();
  const std::int64_t problems = counts.missed + counts.late + counts.dropped + counts.errors;
  state_ = problems > reported_problems_ ? module_status::STATE_DEGRADED : module_status::STATE_RUNNING;
  reported_problems_ = problems;
  publish_status();
  publish_timing();
}

module_status Module::counted_status() const {
  module_status status{};
  status.utime = utime_;
  status.module = name_;
  status.state = state_;
  status.dropped = dropped_;
  status.errors = errors_;
  status.last_error = last_error_;
  status.warning = warning_;
  for (const bus::Reception* reception : receptions_) {
    status.received += reception->sequence.used;
    status.missed += reception->sequence.missed;
    status.duplicates += reception->sequence.duplicates;
    status.late += reception->sequence.late;
    status.errors += reception->refused;
    if (status.last_error.empty()) status.last_error = reception->last_error;
  }
  return status;
}

void Module::publish_status() {
  status_utime_ = utime_;
  publish(bus::channel::kModuleStatus, counted_status());
}

void Module::publish_timing() {
  const double now = wall_clock();
  timing message{};
  message.utime = utime_;
  message.module = name_;
  message.handled = window_.count();
  message.window_s = now - window_begin_;
  if (message.window_s > 0.0) {
    message.rate_hz = static_cast<double>(window_.count()) / message.window_s;
    message.cpu_share = window_cpu_ / message.window_s;
  }
  message.latency_p50_s = window_.percentile(0.50);
  message.latency_p95_s = window_.percentile(0.95);
  message.latency_p99_s = window_.percentile(0.99);
  message.latency_max_s = window_.max();
  publish(bus::channel::kTiming, std::move(message));
  window_.clear();
  window_cpu_ = 0.0;
  window_begin_ = now;
}

}  // namespace noctule::modules
