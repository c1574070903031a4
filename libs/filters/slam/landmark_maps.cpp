#include "filters/slam/landmark_maps.hpp"

#include <algorithm>

#include "particle/parallel.hpp"

namespace noctule::filters {

template <class Block>
void LandmarkMaps::Pool<Block>::grow() {
  const std::size_t first = references_.size();
  chunks_.push_back(std::make_unique<Block[]>(kChunk));
  references_.resize(first + kChunk, 0);
  unused_.reserve(references_.size());
  for (std::size_t i = kChunk; i-- > 0;) unused_.push_back(static_cast<std::uint32_t>(first + i));
}

LandmarkMaps::LandmarkMaps(std::size_t particles, MapStorage storage)
    : storage_(storage), shared_(storage == MapStorage::shared), sizes_(particles, 0) {}

std::size_t LandmarkMaps::largest() const {
  return sizes_.empty() ? 0 : *std::ranges::max_element(sizes_);
}

LandmarkMaps::Table& LandmarkMaps::own_table(std::size_t particle, std::size_t index) {
  std::uint32_t& root = roots_[particle * root_ + index];
  if (root == kNone) {
    root = tables_.take();
    std::ranges::fill(tables_[root].pages, kNone);
  } else if (tables_.is_shared(root)) {
    const std::uint32_t copy = tables_.take();
    tables_[copy] = tables_[root];
    for (const std::uint32_t page : tables_[copy].pages) {
      if (page == kNone) break;
      pages_.share(page);
    }
    tables_.drop(root);
    root = copy;
  }
  return tables_[root];
}

void LandmarkMaps::own_page(std::size_t particle, std::size_t index) {
  const std::uint32_t root = roots_[particle * root_ + index / kTable];
  // Nothing to do for most: the page is there, and nobody shares it or its table.
  if (root != kNone && !tables_.is_shared(root)) {
    const std::uint32_t page = tables_[root].pages[index % kTable];
    if (page != kNone && !pages_.is_shared(page)) return;
  }
  std::uint32_t& page = own_table(particle, index / kTable).pages[index % kTable];
  if (page == kNone) {
    page = pages_.take();
  } else if (pages_.is_shared(page)) {
    const std::uint32_t copy = pages_.take();
    copies_.push_back({page, copy});
    pages_.drop(page);
    page = copy;
  }
}

void LandmarkMaps::own(std::size_t particle, std::size_t slot) {
  if (shared_) own_page(particle, slot / kPage);
}

void LandmarkMaps::own(std::size_t particle, std::span<const std::int32_t> slots) {
  if (!shared_) return;
  std::size_t latest = ~std::size_t{0};  // neighbours are often seen together
  for (const std::int32_t slot : slots) {
    if (slot < 0 || static_cast<std::uint32_t>(slot) >= sizes_[particle]) continue;
    const std::size_t index = static_cast<std::size_t>(slot) / kPage;
    if (index != latest) own_page(particle, index);
    latest = index;
  }
}

void LandmarkMaps::reserve(std::size_t particle, std::size_t more) {
  if (more == 0) return;
  const std::size_t size = sizes_[particle] + more;
  if (!shared_ && storage_ == MapStorage::automatic && size > kFlatBelow) begin_sharing();
  if (!shared_) {
    if (size > row_) widen_flat(size);
    return;
  }
  const std::size_t pages = (size + kPage - 1) / kPage;
  if ((pages + kTable - 1) / kTable > root_) widen_roots((pages + kTable - 1) / kTable);
  for (std::size_t p = sizes_[particle] / kPage; p < pages; ++p) own_page(particle, p);
}

void LandmarkMaps::copy_pages(int threads) {
  if (copies_.empty()) return;
  constexpr std::size_t worth_a_thread = 64;
  particle::for_blocks(copies_.size(), copies_.size() < worth_a_thread ? 1 : threads,
                       [this](std::size_t begin, std::size_t end) {
                         for (std::size_t k = begin; k < end; ++k) pages_[copies_[k].to] = pages_[copies_[k].from];
                       });
  copies_.clear();
}

void LandmarkMaps::widen_flat(std::size_t landmarks) {
  const std::size_t row = std::max(landmarks, row_ + row_ / 2 + 8);
  std::vector<PointLandmark> wider(row * sizes_.size());
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    std::copy_n(flat_.begin() + static_cast<std::ptrdiff_t>(i * row_), sizes_[i],
                wider.begin() + static_cast<std::ptrdiff_t>(i * row));
  }
  flat_ = std::move(wider);
  row_ = row;
}

void LandmarkMaps::widen_roots(std::size_t tables) {
  std::vector<std::uint32_t> wider(tables * sizes_.size(), kNone);
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    std::copy_n(roots_.begin() + static_cast<std::ptrdiff_t>(i * root_), root_,
                wider.begin() + static_cast<std::ptrdiff_t>(i * tables));
  }
  roots_ = std::move(wider);
  root_ = tables;
}

void LandmarkMaps::begin_sharing() {
  shared_ = true;
  const std::vector<std::uint32_t> sizes = sizes_;
  std::ranges::fill(sizes_, 0u);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    reserve(i, row_);  // all the room that has been promised
    for (std::size_t k = 0; k < sizes[i]; ++k) append(i, flat_[i * row_ + k]);
  }
  flat_ = {};
  row_ = 0;
}

void LandmarkMaps::drop_table(std::uint32_t table) {
  if (table == kNone || !tables_.drop(table)) return;
  for (const std::uint32_t page : tables_[table].pages) {
    if (page == kNone) break;
    pages_.drop(page);
  }
}

void LandmarkMaps::resample(std::span<const std::uint32_t> ancestors) {
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    const std::size_t a = ancestors[i];
    if (a == i) continue;
    sizes_[i] = sizes_[a];
    if (!shared_) {
      std::copy_n(flat_.begin() + static_cast<std::ptrdiff_t>(a * row_), sizes_[a],
                  flat_.begin() + static_cast<std::ptrdiff_t>(i * row_));
      continue;
    }
    for (std::size_t t = 0; t < root_; ++t) {
      std::uint32_t& mine = roots_[i * root_ + t];
      const std::uint32_t theirs = roots_[a * root_ + t];
      if (theirs != kNone) tables_.share(theirs);
      drop_table(mine);
      mine = theirs;
    }
  }
}

void LandmarkMaps::transfer(StateArchive& archive) {
  archive(shared_, sizes_, row_, flat_, root_, roots_);
  tables_.transfer(archive, [&](Table& table) {
    for (std::uint32_t& page : table.pages) archive(page);
  });
  pages_.transfer(archive, [&](Page& page) {
    for (PointLandmark& m : page.landmarks) archive(m);
  });
}

std::size_t LandmarkMaps::bytes() const {
  return sizes_.size() * sizeof(sizes_[0]) + flat_.size() * sizeof(PointLandmark) + roots_.size() * sizeof(roots_[0]) +
         tables_.used() * (sizeof(Table) + sizeof(std::uint32_t)) +
         pages_.used() * (sizeof(Page) + sizeof(std::uint32_t));
}

}  // namespace noctule::filters
