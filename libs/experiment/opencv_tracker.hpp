#pragma once
/// The trackers of opencv_contrib, with their defaults: the bar that a user knows.
#include <memory>
#include <string>

#include "core/image.hpp"
#include "core/image_box.hpp"

namespace noctule::experiment {

/// KCF (Henriques and others 2015) or CSR-DCF (Lukezic and others 2017).
class OpencvTracker {
 public:
  /// \param name `opencv_kcf` or `opencv_csrt`
  explicit OpencvTracker(const std::string& name);
  ~OpencvTracker();

  void start(const Image& image, const ImageBox& target);
  /// Where it finds no target it stays where it was.
  const ImageBox& track(const Image& image);

 private:
  struct Tracker;
  std::unique_ptr<Tracker> tracker_;
  ImageBox box_;
};

}  // namespace noctule::experiment
