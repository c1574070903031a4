noctule_bench(particle ROOMS particle)
# MRPT's resampling beside ours, where it is installed.
find_package(mrpt-bayes QUIET)
if(mrpt-bayes_FOUND)
  target_link_libraries(bench_particle PRIVATE mrpt::bayes)
  target_compile_definitions(bench_particle PRIVATE NOCTULE_WITH_MRPT)
endif()
