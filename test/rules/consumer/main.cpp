#include <cstdio>

#include "models/ultrasonic.hpp"

int main() {
  const noctule::Wall wall{2.0, 0.0};
  const double range = noctule::models::predict_echo(noctule::Vector2(0.5, 0.0), wall).range;
  std::printf("range %.3f m\n", range);
  return range == 1.5 ? 0 : 1;
}
