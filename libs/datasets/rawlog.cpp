#include "datasets/rawlog.hpp"

#include "datasets/file_content.hpp"
#include "datasets/plugin.hpp"

namespace noctule::datasets {
namespace {

const RawlogPlugin& plugin() {
  static const auto& loaded =
      *static_cast<const RawlogPlugin*>(plugin_symbol("rawlog", "libnoctule_mrpt.so", "noctule_rawlog_plugin"));
  return loaded;
}

Recording read(const RawlogParameters& p) {
  const FileContent content = read_file(p.path);
  Recording recording;
  recording.world.name = p.path.stem().string();
  if (content.cut_off) recording.notes.push_back(p.path.string() + ": the compressed file is cut off");
  plugin().read(p, content.bytes, recording);
  return recording;
}

}  // namespace

RawlogSource::RawlogSource(const RawlogParameters& parameters) : RecordedSource(read(parameters)) {}

RawlogWriter::RawlogWriter(const std::filesystem::path& path) : sink_(plugin().create(path)) {}

}  // namespace noctule::datasets
