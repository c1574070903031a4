#include "bus/codec.hpp"

#include <cinttypes>
#include <cstdio>

namespace noctule::bus::detail {
namespace {

std::string hexadecimal(std::uint64_t value) {
  char text[19];
  std::snprintf(text, sizeof text, "0x%016" PRIx64, value);
  return text;
}

}  // namespace

std::string decode_problem(Bytes bytes, const char* type, std::int64_t hash, int decoded) {
  const std::string expected = "expected a message of type " + std::string(type);
  const std::string got = ", got " + std::to_string(bytes.size()) + " bytes";
  if (bytes.size() < 8) return expected + got;
  std::uint64_t found = 0;
  for (std::size_t i = 0; i < 8; ++i) found = found << 8 | bytes[i];
  if (found != static_cast<std::uint64_t>(hash))
    return expected + " (hash " + hexadecimal(static_cast<std::uint64_t>(hash)) + "), got one of hash " +
           hexadecimal(found) + ": another type or another version of it";
  if (decoded >= 0) return expected + " in " + std::to_string(decoded) + " bytes" + got;
  return expected + got + " that are cut off or corrupt";
}

}  // namespace noctule::bus::detail
