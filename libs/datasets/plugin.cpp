#include "datasets/plugin.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "core/error.hpp"

namespace noctule::datasets {

const void* plugin_symbol(const std::string& user, const std::string& library, const char* symbol) {
  std::error_code none;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
  void* handle = dlopen((folder / ".." / "lib" / library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* found = handle == nullptr ? nullptr : dlsym(handle, symbol);
  if (found == nullptr) throw InputError(user + ": expected the plug-in " + library + ", got: " + dlerror());
  return found;
}

}  // namespace noctule::datasets
