#include "datasets/rawlog.hpp"

#include <dlfcn.h>

#include <system_error>

#include "core/error.hpp"
#include "datasets/file_content.hpp"

namespace noctule::datasets {
namespace {

// The plug-in beside the executable (build tree, installation), else wherever the loader looks.
const RawlogPlugin& load_plugin() {
  constexpr const char* kName = "libnoctule_mrpt.so";
  std::error_code none;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
  void* library = dlopen((folder / ".." / "lib" / kName).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) library = dlopen(kName, RTLD_NOW | RTLD_LOCAL);
  const void* symbol = library == nullptr ? nullptr : dlsym(library, "noctule_rawlog_plugin");
  if (symbol == nullptr) throw InputError(std::string("rawlog: expected the plug-in ") + kName + ", got: " + dlerror());
  return *static_cast<const RawlogPlugin*>(symbol);
}

const RawlogPlugin& plugin() {
  static const RawlogPlugin& loaded = load_plugin();
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
