# cmake -DHEADER=type.hpp -P harden_decode.cmake
#   lcm-gen 1.3.1 resizes an array to whatever count the bytes say, and multiplies that count in 32 bits: a corrupt
#   count allocates gigabytes or reads behind the buffer. Every element takes at least one byte, so that a count beyond
#   the bytes that are left is refused first.
cmake_minimum_required(VERSION 3.25)
file(READ ${HEADER} code)
string(REGEX MATCHALL "\\.resize\\(" resizes "${code}")
string(REGEX MATCHALL "this->[a-z_]+\\.resize\\(this->[a-z_]+\\)" known "${code}")
list(LENGTH resizes resize_count)
list(LENGTH known known_count)
if(NOT resize_count EQUAL known_count)
  message(FATAL_ERROR "${HEADER}: lcm-gen writes a resize that this script does not know")
endif()
string(REGEX REPLACE "(this->[a-z_]+\\.resize\\((this->[a-z_]+)\\);)"
                     "if(\\2 < 0 || \\2 > maxlen - pos) return -1;\n        \\1" code "${code}")
file(WRITE ${HEADER} "${code}")
