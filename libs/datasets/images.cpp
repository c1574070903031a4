#include "datasets/images.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>

#include "core/error.hpp"
#include "datasets/file_content.hpp"
#include "datasets/plugin.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

namespace fs = std::filesystem;

const ImagePlugin& plugin() {
  static const auto& loaded =
      *static_cast<const ImagePlugin*>(plugin_symbol("images", "libnoctule_images.so", "noctule_image_plugin"));
  return loaded;
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_picture(const fs::path& path) {
  constexpr std::array kExtensions = {".jpg", ".jpeg", ".png", ".pgm", ".ppm", ".bmp", ".tif", ".tiff"};
  const std::string extension = lower_case(path.extension().string());
  return std::ranges::any_of(kExtensions, [&](const char* known) { return extension == known; });
}

void require_consistent(const Image& image) {
  if (image.consistent()) return;
  throw InputError("image: expected as many pixels as its size says, got " + std::to_string(image.pixels.size()) +
                   " for " + std::to_string(image.width) + " x " + std::to_string(image.height) + " x " +
                   std::to_string(image.channels));
}

std::int64_t microseconds(double seconds) {
  return std::llround(1e6 * seconds);
}

class Folder : public ObservationSource {
 public:
  explicit Folder(const ImageFolderParameters& p) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(p.path, error)) {
      if (entry.is_regular_file() && is_picture(entry.path())) files_.push_back(entry.path());
    }
    if (error) throw InputError(p.path.string() + ": expected a folder of pictures, got: " + error.message());
    if (files_.empty()) throw InputError(p.path.string() + ": expected a folder of pictures, got none in it");
    std::ranges::sort(files_);
    world_.name = p.path.filename().string();
    if (p.times.empty()) {
      for (std::size_t i = 0; i < files_.size(); ++i) utimes_.push_back(microseconds(static_cast<double>(i) / p.rate));
    } else {
      read_times(p.times);
    }
  }

  std::optional<Observation> next() override {
    if (next_ == files_.size()) return std::nullopt;
    CameraImage image{{utimes_[next_], static_cast<std::int64_t>(next_)}, read_image(files_[next_])};
    ++next_;
    return image;
  }
  [[nodiscard]] const KnownWorld& world() const override { return world_; }

 private:
  void read_times(const fs::path& file) {
    const Table table(file, {.columns = {"time_s"}, .comment = '#'});
    table.require_ascending(0, false);
    if (static_cast<std::size_t>(table.rows()) != files_.size()) {
      throw InputError(file.string() + ": expected " + std::to_string(files_.size()) +
                       " times, one for each picture, got " + std::to_string(table.rows()));
    }
    for (int row = 0; row < table.rows(); ++row) utimes_.push_back(table.utime(row, 0, 1.0));
  }

  std::vector<fs::path> files_;
  std::vector<std::int64_t> utimes_;
  std::size_t next_ = 0;
  KnownWorld world_;
};

/// A video or a camera. Two pictures of one time are told apart by a microsecond.
class Film : public ObservationSource {
 public:
  using Clock = std::function<std::int64_t(std::int64_t number, double time)>;

  Film(VideoStream* stream, std::string name, Clock clock, std::int64_t most)
      : stream_(stream), clock_(std::move(clock)), most_(most) {
    world_.name = std::move(name);
  }

  std::optional<Observation> next() override {
    CameraImage image;
    double time = 0.0;
    if ((most_ > 0 && number_ == most_) || !stream_->next(image.image, time)) return std::nullopt;
    const std::int64_t utime = clock_(number_, time);
    last_utime_ = number_ == 0 ? utime : std::max(utime, last_utime_ + 1);
    image.stamp = {last_utime_, number_++};
    return image;
  }
  [[nodiscard]] const KnownWorld& world() const override { return world_; }

 private:
  std::unique_ptr<VideoStream> stream_;
  Clock clock_;
  std::int64_t most_;
  std::int64_t number_ = 0;
  std::int64_t last_utime_ = 0;
  KnownWorld world_;
};

}  // namespace

Image read_image(const fs::path& path) {
  const FileContent content = read_file(path);
  Image image;
  const auto* begin = reinterpret_cast<const std::uint8_t*>(content.bytes.data());
  if (!plugin().decode({begin, content.bytes.size()}, image)) {
    throw InputError(path.string() + ": expected a picture, got " + std::to_string(content.bytes.size()) +
                     " bytes that are none");
  }
  return image;
}

Image decode_image(std::span<const std::uint8_t> bytes) {
  Image image;
  if (!plugin().decode(bytes, image)) {
    throw InputError("image: expected the bytes of a picture, got " + std::to_string(bytes.size()) + " that are none");
  }
  return image;
}

std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality) {
  require_consistent(image);
  std::vector<std::uint8_t> bytes;
  if (!plugin().encode(image, ".jpg", quality, bytes)) throw InputError("image: cannot be written as JPEG");
  return bytes;
}

void write_image(const fs::path& path, const Image& image) {
  require_consistent(image);
  std::vector<std::uint8_t> bytes;
  if (!plugin().encode(image, lower_case(path.extension().string()), 95, bytes)) {
    throw InputError(path.string() + ": expected the name of a picture (.png, .jpg ...)");
  }
  std::ofstream out(path, std::ios::binary);
  if (!out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())).flush()) {
    throw InputError(path.string() + ": cannot be written");
  }
}

std::unique_ptr<ObservationSource> open_images(const ImageFolderParameters& parameters) {
  return std::make_unique<Folder>(parameters);
}

std::unique_ptr<ObservationSource> open_video(const VideoParameters& p) {
  VideoStream* stream = fs::is_regular_file(p.path) ? plugin().open_file(p.path.string()) : nullptr;
  if (stream == nullptr) throw InputError(p.path.string() + ": expected a video, got none that can be read");
  return std::make_unique<Film>(
      stream, p.path.stem().string(),
      [rate = p.rate](std::int64_t number, double time) {
        return microseconds(rate > 0.0 ? static_cast<double>(number) / rate : time);
      },
      0);
}

std::unique_ptr<ObservationSource> open_camera(const CameraDeviceParameters& p) {
  const std::string name = "/dev/video" + std::to_string(p.device);
  VideoStream* stream = fs::exists(name) ? plugin().open_device(p) : nullptr;
  if (stream == nullptr) throw InputError(name + ": expected a camera, got none that can be opened");
  const auto now = [](std::int64_t, double) {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return std::int64_t{std::chrono::duration_cast<std::chrono::microseconds>(since).count()};
  };
  return std::make_unique<Film>(stream, name, now, p.pictures);
}

}  // namespace noctule::datasets
