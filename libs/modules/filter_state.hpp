#pragma once
/// Files of filter states: to go on later as if nothing had been, or to know a map beforehand.
#include <cstdint>
#include <filesystem>

#include "filters/slam/make_slam_filter.hpp"

namespace noctule::modules {

/// Which filter a state is of: it goes on bit by bit only with the same parameters and seed.
struct FilterIdentity {
  filters::SlamFilterParameters parameters;
  std::uint64_t seed = 0;
};

/// Written whole or not at all. The file: the line "noctule filter state", version and byte order (32 bits each), the
/// filter's parameters as YAML, its seed and its map, its state, and a CRC-64 of all that (ECMA-182, as in xz).
/// \param utime of the latest observation that the filter has seen
/// \throws InputError when the file cannot be written
void save_filter_state(const std::filesystem::path& file, filters::SlamFilter& filter, const FilterIdentity& identity,
                       std::int64_t utime);

/// \param filter new, made of the same parameters and seed
/// \return time of the latest observation that the filter had seen
/// \throws InputError with the file's name when it is no such file, of another version, damaged, or of another filter;
///         the filter is of no use then
std::int64_t load_filter_state(const std::filesystem::path& file, filters::SlamFilter& filter,
                               const FilterIdentity& identity);

/// The map alone, of whatever filter. \throws InputError as load_filter_state(), whatever filter it is of
[[nodiscard]] LandmarkMap load_state_map(const std::filesystem::path& file);

}  // namespace noctule::modules
