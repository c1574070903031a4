# cmake --install: the algorithm rooms as noctule::NAME for find_package(noctule COMPONENTS filters ...), the
# executables, and the configuration files. A user of one room finds and links no more than that room needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(NOCTULE_EXPORTED_ROOMS core models particle config eval sim sensors filters mapping planning smoothing datasets report)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/noctule)

# Package of each third-party target that a room may link.
set(package_of_Eigen3::Eigen Eigen3)
set(package_of_yaml-cpp yaml-cpp)
set(package_of_nlohmann_json::nlohmann_json nlohmann_json)
set(package_of_TBB::tbb TBB)
set(package_of_ZLIB::ZLIB ZLIB)
set(package_of_Threads::Threads Threads)
set(package_of_Ceres::ceres Ceres)
foreach(module core imgproc features2d calib3d aruco video)
  set(package_of_opencv_${module} OpenCV)
endforeach()

set(NOCTULE_COMPONENT_TABLE "")
get_property(rooms GLOBAL PROPERTY NOCTULE_ROOMS)
foreach(room ${rooms})
  if(NOT room IN_LIST NOCTULE_EXPORTED_ROOMS)
    continue()
  endif()
  install(TARGETS noctule_${room} EXPORT noctule-${room} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT noctule-${room} NAMESPACE noctule:: DESTINATION ${package_dir} FILE noctule-${room}.cmake)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/libs/${room} DESTINATION include/noctule FILES_MATCHING PATTERN "*.hpp")
  get_property(depends GLOBAL PROPERTY NOCTULE_ROOM_${room}_DEPENDS)
  get_property(links GLOBAL PROPERTY NOCTULE_ROOM_${room}_LINKS)
  set(packages "")
  foreach(link ${links})
    if(link IN_LIST CMAKE_DL_LIBS)  # of the C library
      continue()
    endif()
    if(NOT DEFINED package_of_${link})
      message(FATAL_ERROR "cmake/Install.cmake: room '${room}' links ${link}: name its package there")
    endif()
    list(APPEND packages ${package_of_${link}})
  endforeach()
  string(APPEND NOCTULE_COMPONENT_TABLE "set(noctule_depends_${room} ${depends})\nset(noctule_packages_${room} ${packages})\n")
  list(APPEND NOCTULE_AVAILABLE_COMPONENTS ${room})
endforeach()

# The plug-ins that read and write MRPT's rawlogs, and pictures.
install(TARGETS noctule_datasets_mrpt noctule_datasets_images LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/noctuleConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/noctuleConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/noctuleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/noctuleConfig.cmake ${PROJECT_BINARY_DIR}/noctuleConfigVersion.cmake
        DESTINATION ${package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/noctule/config)
