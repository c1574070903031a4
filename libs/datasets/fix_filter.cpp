#include "datasets/fix_filter.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::datasets {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::vector<std::size_t> longest_chain(std::span<const FixAndOdometry> fixes, const FixFilterParameters& p) {
  std::vector<int> length(fixes.size(), 1);  // of the longest chain that ends here
  std::vector<std::size_t> before(fixes.size(), kNone);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    for (std::size_t j = i; j-- > 0;) {  // of equally long chains the one whose last fix is nearest in time
      if (length[j] < length[i]) continue;
      const double distance = (fixes[i].fix.position - fixes[j].fix.position).norm();
      const double driven = (fixes[i].dead_reckoned - fixes[j].dead_reckoned).norm();
      if (std::abs(distance - driven) > p.margin + p.per_way * (fixes[i].way - fixes[j].way)) continue;
      length[i] = length[j] + 1;
      before[i] = j;
    }
  }
  std::vector<std::size_t> chain;
  if (fixes.empty()) return chain;
  auto i = static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  for (; i != kNone; i = before[i]) chain.push_back(i);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace

std::vector<std::size_t> believed_fixes(std::span<const FixAndOdometry> fixes, const FixFilterParameters& p) {
  const std::vector<std::size_t> chain = longest_chain(fixes, p);
  std::vector<std::size_t> believed;
  for (std::size_t begin = 0; begin < chain.size();) {
    std::size_t end = begin + 1;
    while (end < chain.size() && seconds(fixes[chain[end]].fix.utime - fixes[chain[end - 1]].fix.utime) <= p.pause)
      ++end;
    if (end - begin >= static_cast<std::size_t>(p.least_run)) {
      believed.insert(believed.end(), chain.begin() + static_cast<std::ptrdiff_t>(begin),
                      chain.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
  return believed;
}

}  // namespace noctule::datasets
