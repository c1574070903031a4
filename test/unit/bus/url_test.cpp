#include "bus/url.hpp"

#include <gtest/gtest.h>

#include <cerrno>

#include "core/error.hpp"

namespace noctule::bus {
namespace {

TEST(Url, MemoryHasNoAddress) {
  EXPECT_FALSE(parse_url("memq://").has_value());
}

TEST(Url, UdpmDefaultsStayOnThisHost) {
  EXPECT_EQ(parse_url("udpm://"), (UdpmAddress{"239.255.76.67", 7667, 0, 0}));
  EXPECT_EQ(parse_url("udpm://:7701"), (UdpmAddress{"239.255.76.67", 7701, 0, 0}));
  EXPECT_EQ(parse_url("udpm://224.1.2.3"), (UdpmAddress{"224.1.2.3", 7667, 0, 0}));
  EXPECT_EQ(parse_url("udpm://224.1.2.3:99?ttl=1&recv_buf_size=65536"), (UdpmAddress{"224.1.2.3", 99, 1, 65536}));
}

TEST(Url, WritesEveryOptionOut) {
  EXPECT_EQ(to_url(UdpmAddress{}), "udpm://239.255.76.67:7667?ttl=0");
  const UdpmAddress address{"224.1.2.3", 99, 1, 65536};
  EXPECT_EQ(parse_url(to_url(address)), address);
}

TEST(Url, RefusesWithWhatWasExpected) {
  const auto refusal = [](const std::string& url) -> std::string {
    try {
      (void)parse_url(url);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(""), "bus url '': expected memq:// or udpm://GROUP:PORT?ttl=N");
  EXPECT_EQ(refusal("file:///tmp/x.lcmlog"),
            "bus url 'file:///tmp/x.lcmlog': expected memq:// or udpm://GROUP:PORT?ttl=N");
  EXPECT_EQ(refusal("udpm://10.0.0.1:7667"),
            "bus url 'udpm://10.0.0.1:7667': expected a multicast group, 224.0.0.0 to 239.255.255.255, got '10.0.0.1'");
  EXPECT_EQ(refusal("udpm://239.255.76.67:70000"),
            "bus url 'udpm://239.255.76.67:70000': expected a port from 1 to 65535, got '70000'");
  EXPECT_EQ(refusal("udpm://?ttl=-1"), "bus url 'udpm://?ttl=-1': expected ttl from 0 to 255, got '-1'");
  EXPECT_EQ(refusal("udpm://?tll=1"), "bus url 'udpm://?tll=1': expected the options ttl and recv_buf_size, got 'tll'");
}

TEST(Url, NoRouteIsExplainedWithTheCommandThatMendsIt) {
  for (const int error : {ENETUNREACH, ENODEV}) {
    const std::string text = multicast_problem(UdpmAddress{}, error);
    EXPECT_NE(text.find("udpm://239.255.76.67:7667?ttl=0"), std::string::npos) << text;
    EXPECT_NE(text.find("sudo ip route add 224.0.0.0/4 dev lo"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST(Url, OtherFailuresNameTheSystemsReasonAndNoRoute) {
  const std::string text = multicast_problem(UdpmAddress{}, EPERM);
  EXPECT_NE(text.find("Operation not permitted"), std::string::npos) << text;
  EXPECT_EQ(text.find("route"), std::string::npos) << text;
}

}  // namespace
}  // namespace noctule::bus
