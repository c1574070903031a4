#pragma once
/// What a filter refuses at its door, beside what every estimator refuses (core/observation_checks.hpp). Each throws
/// InputError with the observation, the value, and what was expected.
#include <cstdint>
#include <optional>

#include "core/features.hpp"
#include "core/observation_checks.hpp"

namespace noctule::filters {

using noctule::check;

/// Finite sensor poses, ranges of hits finite and positive, half angle in (0, pi].
void check(const UltrasonicScan&);
/// Finite numbers; readings of this scan name its beams.
void check(const ContourFeatures&, const UltrasonicScan&);
/// The seq is above the last one of its channel, which it becomes.
void check_order(const char* what, const Stamp& stamp, std::optional<std::int64_t>& last);

}  // namespace noctule::filters
