#include "bus/inbox.hpp"

namespace noctule::bus {
namespace {

SequenceCounts operator+(SequenceCounts a, const SequenceCounts& b) {
  a.used += b.used;
  a.missed += b.missed;
  a.duplicates += b.duplicates;
  a.late += b.late;
  a.restarts += b.restarts;
  return a;
}

}  // namespace

void Inbox::count(Bytes bytes) {
  ++reception_.arrived.messages;
  reception_.arrived.bytes += static_cast<std::int64_t>(bytes.size());
}

bool Inbox::admit(std::string_view sender, std::int64_t seq, std::int64_t utime) {
  if (seq < 0) throw InputError("seq: expected a number >= 0, got " + std::to_string(seq));
  auto at = senders_.find(sender);
  if (at == senders_.end()) at = senders_.emplace(sender, SequenceCounter{}).first;
  const Arrival arrival = at->second.arrive(seq, utime);
  reception_.sequence = {};
  for (const auto& [name, counter] : senders_) reception_.sequence = reception_.sequence + counter.counts();
  return arrival == Arrival::fresh || arrival == Arrival::restarted;
}

void Inbox::refuse(const std::string& what, const ProblemHandler& problem) {
  ++reception_.refused;
  reception_.last_error = what;
  if (problem) problem(reception_.channel, what);
}

void Inbox::handler_failed(const std::string& what) {
  ++reception_.handler_errors;
  reception_.last_error = what;
}

}  // namespace noctule::bus
