#pragma once
/// Where a bus runs: `memq://` inside this process, `udpm://GROUP:PORT?ttl=N` between processes by UDP multicast.
#include <optional>
#include <string>

namespace noctule::bus {

/// A parsed `udpm://GROUP:PORT?ttl=N&recv_buf_size=N`; group, port and options may be left out.
struct UdpmAddress {
  std::string group = "239.255.76.67";  ///< LCM's own defaults
  int port = 7667;
  int ttl = 0;            ///< 0: nothing leaves this host; 1: the local network
  int recv_buf_size = 0;  ///< [bytes] of the kernel's receive buffer; 0: the system's default
  friend bool operator==(const UdpmAddress&, const UdpmAddress&) = default;
};

/// \returns nothing for `memq://`
/// \throws InputError for every other URL that is not a udpm address
[[nodiscard]] std::optional<UdpmAddress> parse_url(const std::string& url);

/// The address with all its options written out, as LCM reads it.
[[nodiscard]] std::string to_url(const UdpmAddress&);

/// Tries to address the group and to join it, without sending anything.
/// \returns errno of what failed, 0 when the host can do both
[[nodiscard]] int probe_multicast(const UdpmAddress&);

/// What to tell a user whose host cannot multicast, with the command that mends it.
/// \param error errno from probe_multicast(), not 0
[[nodiscard]] std::string multicast_problem(const UdpmAddress&, int error);

}  // namespace noctule::bus
