noctule_bench(mapping ROOMS mapping)
target_include_directories(bench_mapping PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the heptagon
# Second opinions, where they are installed.
find_package(OpenCV QUIET COMPONENTS core imgproc)
if(OpenCV_FOUND)
  target_include_directories(bench_mapping SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
  target_link_libraries(bench_mapping PRIVATE ${OpenCV_LIBS})
  target_compile_definitions(bench_mapping PRIVATE NOCTULE_WITH_OPENCV)
endif()
find_package(mrpt-math QUIET)
if(mrpt-math_FOUND)
  target_link_libraries(bench_mapping PRIVATE mrpt::math)
  target_compile_definitions(bench_mapping PRIVATE NOCTULE_WITH_MRPT)
endif()
