#pragma once
/// Pictures in files, videos and cameras. The coders themselves are in a plug-in (libs/datasets_images) that is loaded
/// when the first picture is opened: linking them would cost every program 140 to 240 shared objects.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/image.hpp"
#include "core/parameters.hpp"
#include "core/source.hpp"

namespace noctule::datasets {

/// Grey or colour, as the file is. \throws InputError for a file that is missing or no picture
[[nodiscard]] Image read_image(const std::filesystem::path& path);
/// The same from the bytes of a file (JPEG, PNG ...). \throws InputError where they are no whole picture
[[nodiscard]] Image decode_image(std::span<const std::uint8_t> bytes);
/// \param quality from 1 to 100 \throws InputError for an image that is not consistent
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality = 90);
/// In the format of the name's extension. \throws InputError where it cannot be written
void write_image(const std::filesystem::path& path, const Image& image);

/// A folder of pictures in the order of their names.
struct ImageFolderParameters {
  std::filesystem::path path;
  double rate = 10.0;
  std::filesystem::path times;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ImageFolderParameters;
    v.field("path", &P::path, "the folder; its pictures are taken in the order of their names");
    v.field("rate_hz", &P::rate, unit::hertz, "pictures a second, where no times are given", positive());
    v.field("times", &P::times, "a file with the time of each picture in seconds, one a line; absent: rate_hz");
  }
};

/// A video file; what it says of its times is used.
struct VideoParameters {
  std::filesystem::path path;
  double rate = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("path", &VideoParameters::path, "the video");
    v.field("rate_hz", &VideoParameters::rate, unit::hertz, "pictures a second; 0: as the file says", at_least(0.0));
  }
};

/// A camera of this machine (Video4Linux), live.
struct CameraDeviceParameters {
  int device = 0;
  int width = 640;
  int height = 480;
  double rate = 30.0;
  int pictures = 0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = CameraDeviceParameters;
    v.field("device", &P::device, unit::one, "number n of /dev/video<n>", between(0, 255));
    v.field("width", &P::width, unit::one, "pixels that are asked for", between(8, 16384));
    v.field("height", &P::height, unit::one, "pixels that are asked for", between(8, 16384));
    v.field("rate_hz", &P::rate, unit::hertz, "pictures a second that are asked for", positive());
    v.field("pictures", &P::pictures, unit::one, "end after so many; 0: never", at_least(0));
  }
};

/// \throws InputError for a folder without pictures, times that do not ascend or are not one for each picture; from
///         next() for a picture that cannot be read
[[nodiscard]] std::unique_ptr<ObservationSource> open_images(const ImageFolderParameters& parameters);
/// \throws InputError for a file that is missing or no video
[[nodiscard]] std::unique_ptr<ObservationSource> open_video(const VideoParameters& parameters);
/// \throws InputError where there is no such camera
[[nodiscard]] std::unique_ptr<ObservationSource> open_camera(const CameraDeviceParameters& parameters);

/// Pictures one by one.
class VideoStream {
 public:
  virtual ~VideoStream() = default;
  /// False at the end. \param[out] time since the first picture, where the stream knows it [s]
  [[nodiscard]] virtual bool next(Image& image, double& time) = 0;
};

/// What the plug-in exports under the name `noctule_image_plugin`. Nothing it cannot read or write throws: it returns
/// nothing.
struct ImagePlugin {
  bool (*decode)(std::span<const std::uint8_t> bytes, Image& image);
  /// \param extension with its dot
  bool (*encode)(const Image& image, const std::string& extension, int quality, std::vector<std::uint8_t>& bytes);
  VideoStream* (*open_file)(const std::string& path);  ///< the caller owns it
  VideoStream* (*open_device)(const CameraDeviceParameters&);
};

}  // namespace noctule::datasets
