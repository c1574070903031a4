#include "bus/bus.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "bus/url.hpp"

namespace noctule::bus {
namespace {

/// Messages that may wait for one subscription; new ones beyond it are lost. LCM's default of 30 is less than one burst
/// of a replayed log.
constexpr int kReceiveQueue = 10000;

std::string what(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& e) {
    return e.what();
  } catch (...) {
    return "unknown exception";
  }
}

/// LCM takes the name of a channel for a regular expression when it subscribes, and 63 bytes of it when it sends.
void check_channel(const std::string& channel) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '/'; };
  if (channel.empty() || channel.size() > LCM_MAX_CHANNEL_NAME_LENGTH || !std::ranges::all_of(channel, plain))
    throw InputError("channel '" + channel + "': expected 1 to " + std::to_string(LCM_MAX_CHANNEL_NAME_LENGTH) +
                     " letters, digits or _ - /");
}

}  // namespace

/// An lcm_t and its URL.
class Bus::Link {
 public:
  explicit Link(const std::string& url) : url_(url) {
    if (const auto address = parse_url(url)) {
      if (const int error = probe_multicast(*address)) throw InputError(multicast_problem(*address, error));
      url_ = to_url(*address);
    }
    lcm_ = lcm_create(url_.c_str());
    if (lcm_ == nullptr) throw InputError("bus url '" + url_ + "': expected an address that LCM can open");
  }
  ~Link() { lcm_destroy(lcm_); }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  [[nodiscard]] lcm_t* get() const { return lcm_; }
  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  std::string url_;
  lcm_t* lcm_ = nullptr;
};

struct Bus::Subscription {
  Bus& bus;
  ByteHandler handler;
  Inbox inbox;

  /// Nothing may be thrown through LCM's C frames: the next handle() would abort.
  static void receive(const lcm_recv_buf_t* buffer, const char*, void* self_pointer) {
    auto& self = *static_cast<Subscription*>(self_pointer);
    try {
      self.handler({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size}, self.inbox);
    } catch (...) {
      const std::exception_ptr error = std::current_exception();
      self.inbox.handler_failed(what(error));
      if (!self.bus.error_) self.bus.error_ = error;
    }
  }
};

Bus::Bus(const std::string& url) : link_(std::make_unique<Link>(url)) {}
Bus::~Bus() = default;

void Bus::publish_bytes(const std::string& channel, std::int64_t utime, Bytes bytes) {
  auto at = published_.find(channel);
  if (at == published_.end()) {
    check_channel(channel);
    at = published_.emplace(channel, Traffic{}).first;
  }
  ++at->second.messages;
  at->second.bytes += static_cast<std::int64_t>(bytes.size());

  if (log_ && !not_logged_.contains(channel)) record(channel, utime, bytes);
  send(*link_, channel, bytes);
  if (mirror_) send(*mirror_, channel, bytes);
}

void Bus::record(const std::string& channel, std::int64_t utime, Bytes bytes) {
  try {
    log_->write(channel, utime, bytes);
  } catch (const InputError&) {
    log_.reset();
    if (!handling_) throw;
    if (!error_) error_ = std::current_exception();
  }
}

void Bus::send(Link& link, const std::string& channel, Bytes bytes) {
  if (lcm_publish(link.get(), channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) == 0) return;
  ++failed_sends_;
  if (problem_) problem_(channel, link.url() + ": " + std::to_string(bytes.size()) + " bytes could not be sent");
}

const Reception& Bus::subscribe_bytes(const std::string& channel, ByteHandler handler) {
  check_channel(channel);
  subscriptions_.push_back(std::unique_ptr<Subscription>(new Subscription{*this, std::move(handler), Inbox(channel)}));
  Subscription& subscription = *subscriptions_.back();
  lcm_subscription_t* handle = lcm_subscribe(link_->get(), channel.c_str(), &Subscription::receive, &subscription);
  if (handle == nullptr)  // udpm: LCM's self test failed
    throw InputError(link_->url() + ": expected to hear our own messages, got none: does a firewall drop multicast?");
  lcm_subscription_set_queue_capacity(handle, kReceiveQueue);
  return subscription.inbox.reception();
}

int Bus::drain() {
  return handle(0, std::nullopt);
}

int Bus::handle_for(std::chrono::milliseconds timeout) {
  return handle(static_cast<int>(timeout.count()), std::chrono::steady_clock::now() + timeout);
}

int Bus::handle(int wait_ms, std::optional<std::chrono::steady_clock::time_point> deadline) {
  if (handling_) throw std::logic_error("a handler must not drain the bus that called it");
  handling_ = true;
  int handled = 0;
  int status = lcm_handle_timeout(link_->get(), wait_ms);
  while (status > 0) {
    ++handled;
    if (deadline && std::chrono::steady_clock::now() >= *deadline) break;
    status = lcm_handle_timeout(link_->get(), 0);
  }
  const bool failed = status < 0 && errno != EINTR;
  handling_ = false;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  if (failed) throw std::runtime_error(link_->url() + ": LCM cannot wait for messages");
  return handled;
}

void Bus::mirror_to(const std::string& url) {
  if (!parse_url(url)) throw InputError("mirror url '" + url + "': expected udpm://GROUP:PORT?ttl=N");
  mirror_ = std::make_unique<Link>(url);
}

void Bus::record_to(LogWriter log, std::set<std::string> except) {
  log_ = std::move(log);
  not_logged_ = std::move(except);
}

std::vector<Reception> Bus::receptions() const {
  std::vector<Reception> all;
  for (const auto& subscription : subscriptions_) all.push_back(subscription->inbox.reception());
  return all;
}

}  // namespace noctule::bus
