#pragma once
/// The landmark maps of all particles. Small maps are stored flat, one row a particle. Large ones in pages that
/// particles share until one of them writes: a resampling costs what changes hands, not particles times landmarks.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "filters/slam/point_landmark.hpp"

namespace noctule::filters {

enum class MapStorage : std::int8_t {
  automatic,  ///< flat as long as the largest map is below LandmarkMaps::kFlatBelow, shared from there on
  flat,
  shared
};

/// Maps are lists of landmarks, addressed by slot. Before landmarks are written, `own` and `reserve` must have been
/// called for them, by one thread; then different particles may be written by different threads.
class LandmarkMaps {
 public:
  static constexpr std::size_t kFlatBelow = 256;  ///< landmarks; measured by bench_landmark_slam

  LandmarkMaps(std::size_t particles, MapStorage storage);

  [[nodiscard]] std::size_t particles() const { return sizes_.size(); }
  /// Number of landmarks of a particle.
  [[nodiscard]] std::size_t size(std::size_t particle) const { return sizes_[particle]; }
  [[nodiscard]] std::size_t largest() const;
  [[nodiscard]] bool shares() const { return shared_; }

  [[nodiscard]] const PointLandmark& at(std::size_t particle, std::size_t slot) const {
    return shared_ ? page(page_of(particle, slot)).landmarks[slot % kPage] : flat_[particle * row_ + slot];
  }
  [[nodiscard]] PointLandmark& writable(std::size_t particle, std::size_t slot) {
    return const_cast<PointLandmark&>(at(particle, slot));
  }

  /// Makes the landmarks of a particle in these slots its own; numbers below 0 and beyond the map are skipped.
  void own(std::size_t particle, std::span<const std::int32_t> slots);
  void own(std::size_t particle, std::size_t slot);
  /// Makes room for `more` landmarks of a particle.
  void reserve(std::size_t particle, std::size_t more);
  /// Copies what own() and reserve() asked for: call it once after them, before any write.
  void copy_pages(int threads);

  /// \pre reserve(particle, ...), and nothing removed since
  void append(std::size_t particle, const PointLandmark& landmark) {
    writable(particle, sizes_[particle]++) = landmark;
  }
  /// Removes a landmark; the last one takes its slot. \pre it is owned
  void remove(std::size_t particle, std::size_t slot) {
    writable(particle, slot) = at(particle, sizes_[particle] - 1);
    --sizes_[particle];
  }

  /// The particle in slot i becomes a copy of the one in ancestors[i]. Survivors stay in place: whoever has a copy
  /// elsewhere is its own ancestor (particle::place_in_slots).
  void resample(std::span<const std::uint32_t> ancestors);

  void transfer(StateArchive& archive);

  /// Memory in use by landmarks and tables, without what is kept for later.
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kPage = 16;   ///< landmarks a page
  static constexpr std::size_t kTable = 32;  ///< pages a table
  static constexpr std::size_t kChunk = 256;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  struct Page {
    PointLandmark landmarks[kPage];
  };
  struct Table {
    std::uint32_t pages[kTable];
  };

  /// Blocks with counted references, never moved. Counts are plain: only one thread at a time shares or frees.
  template <class Block>
  class Pool {
   public:
    [[nodiscard]] Block& operator[](std::uint32_t i) { return chunks_[i / kChunk][i % kChunk]; }
    [[nodiscard]] const Block& operator[](std::uint32_t i) const { return chunks_[i / kChunk][i % kChunk]; }
    /// An unused block with one reference.
    [[nodiscard]] std::uint32_t take() {
      if (unused_.empty()) grow();
      const std::uint32_t i = unused_.back();
      unused_.pop_back();
      references_[i] = 1;
      return i;
    }
    void share(std::uint32_t i) { ++references_[i]; }
    [[nodiscard]] bool is_shared(std::uint32_t i) const { return references_[i] > 1; }
    /// Drops a reference. \return whether it was the last one, so that the block is free again
    bool drop(std::uint32_t i) {
      if (--references_[i] > 0) return false;
      unused_.push_back(i);
      return true;
    }
    [[nodiscard]] std::size_t used() const { return references_.size() - unused_.size(); }
    /// \param block lists what is in one
    template <class Body>
    void transfer(StateArchive& archive, const Body& block) {
      archive(references_, unused_);
      while (chunks_.size() < references_.size() / kChunk) chunks_.push_back(std::make_unique<Block[]>(kChunk));
      for (std::uint32_t i = 0; i < references_.size(); ++i) {
        if (references_[i] > 0) block((*this)[i]);
      }
    }

   private:
    void grow();
    std::vector<std::unique_ptr<Block[]>> chunks_;
    std::vector<std::uint32_t> references_, unused_;
  };

  [[nodiscard]] const Page& page(std::uint32_t i) const { return pages_[i]; }
  [[nodiscard]] std::uint32_t page_of(std::size_t particle, std::size_t slot) const {
    return tables_[roots_[particle * root_ + slot / (kPage * kTable)]].pages[slot / kPage % kTable];
  }
  [[nodiscard]] Table& own_table(std::size_t particle, std::size_t index);
  void own_page(std::size_t particle, std::size_t index);
  void drop_table(std::uint32_t table);
  void widen_flat(std::size_t landmarks);
  void widen_roots(std::size_t tables);
  void begin_sharing();

  MapStorage storage_;
  bool shared_;
  std::vector<std::uint32_t> sizes_;  ///< landmarks of each particle

  // Flat: rows of `row_` landmarks.
  std::size_t row_ = 0;
  std::vector<PointLandmark> flat_;

  // Shared: rows of `root_` tables.
  std::size_t root_ = 0;
  std::vector<std::uint32_t> roots_;
  Pool<Table> tables_;
  Pool<Page> pages_;
  struct Copy {
    std::uint32_t from, to;
  };
  std::vector<Copy> copies_;
};

}  // namespace noctule::filters
