noctule_bench(extractor ROOMS sensors)
target_include_directories(bench_extractor PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the scene generator
