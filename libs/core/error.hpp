#pragma once
#include <stdexcept>
#include <string>

namespace noctule {

/// What the user gave cannot be used: a file, a key, a value, a message. The text is one complete line that names
/// the place (file:line, key), what was expected and what was found. Executables print it and exit with code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace noctule
