# Debian's liblcm-dev has no CMake config, and its lcm.pc asks for GLib's headers, which nothing here includes.
# Target LCM::lcm.
find_path(LCM_INCLUDE_DIR lcm/lcm.h)
find_library(LCM_LIBRARY lcm)
mark_as_advanced(LCM_INCLUDE_DIR LCM_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LCM REQUIRED_VARS LCM_LIBRARY LCM_INCLUDE_DIR
                                  REASON_FAILURE_MESSAGE "on Debian: apt install liblcm-dev")
if(LCM_FOUND AND NOT TARGET LCM::lcm)
  add_library(LCM::lcm UNKNOWN IMPORTED GLOBAL)
  set_target_properties(LCM::lcm PROPERTIES IMPORTED_LOCATION ${LCM_LIBRARY}
                                            INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
endif()
