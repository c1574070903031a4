#include "bus/url.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "core/error.hpp"

namespace noctule::bus {
namespace {

constexpr std::string_view kUdpm = "udpm://";

[[noreturn]] void refuse(const std::string& url, const std::string& expected) {
  throw InputError("bus url '" + url + "': expected " + expected);
}

int integer(const std::string& url, std::string_view key, std::string_view text, int min, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < min || value > max)
    refuse(url, std::string(key) + " from " + std::to_string(min) + " to " + std::to_string(max) + ", got '" +
                    std::string(text) + "'");
  return value;
}

/// Text before the first `separator`; `rest` becomes what follows it.
std::string_view cut(std::string_view& rest, char separator) {
  const auto at = rest.find(separator);
  const std::string_view head = rest.substr(0, at);
  rest = at == std::string_view::npos ? std::string_view{} : rest.substr(at + 1);
  return head;
}

bool is_multicast(const std::string& group) {
  in_addr address{};
  return inet_pton(AF_INET, group.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
}

void parse_option(UdpmAddress& address, const std::string& url, std::string_view option) {
  std::string_view value = option;
  const std::string_view key = cut(value, '=');
  if (key == "ttl") {
    address.ttl = integer(url, key, value, 0, 255);
  } else if (key == "recv_buf_size") {
    address.recv_buf_size = integer(url, key, value, 1, 1 << 30);
  } else {
    refuse(url, "the options ttl and recv_buf_size, got '" + std::string(key) + "'");
  }
}

}  // namespace

std::optional<UdpmAddress> parse_url(const std::string& url) {
  if (url == "memq://") return std::nullopt;
  if (!url.starts_with(kUdpm)) refuse(url, "memq:// or udpm://GROUP:PORT?ttl=N");

  UdpmAddress address;
  std::string_view options = std::string_view(url).substr(kUdpm.size());
  std::string_view port = cut(options, '?');
  const std::string_view group = cut(port, ':');
  if (!group.empty()) address.group = group;
  if (!is_multicast(address.group))
    refuse(url, "a multicast group, 224.0.0.0 to 239.255.255.255, got '" + address.group + "'");
  if (!port.empty()) address.port = integer(url, "a port", port, 1, 65535);
  while (!options.empty()) parse_option(address, url, cut(options, '&'));
  return address;
}

std::string to_url(const UdpmAddress& address) {
  std::string url =
      std::string(kUdpm) + address.group + ':' + std::to_string(address.port) + "?ttl=" + std::to_string(address.ttl);
  if (address.recv_buf_size > 0) url += "&recv_buf_size=" + std::to_string(address.recv_buf_size);
  return url;
}

int probe_multicast(const UdpmAddress& address) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return errno;

  sockaddr_in destination{};
  destination.sin_family = AF_INET;
  destination.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &destination.sin_addr);
  ip_mreq membership{};
  membership.imr_multiaddr = destination.sin_addr;
  membership.imr_interface.s_addr = htonl(INADDR_ANY);

  int error = 0;
  if (connect(fd, reinterpret_cast<const sockaddr*>(&destination), sizeof destination) != 0 ||
      setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
    error = errno;
  close(fd);
  return error;
}

std::string multicast_problem(const UdpmAddress& address, int error) {
  const std::string problem = to_url(address) + ": this host cannot multicast (" + std::strerror(error) + ")";
  if (error == ENETUNREACH || error == ENODEV)
    return problem +
           ": expected a multicast route, got none; to make one on the loopback interface: "
           "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo";
  return problem;
}

}  // namespace noctule::bus
