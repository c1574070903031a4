noctule_bench(sim ROOMS sim config)
target_compile_definitions(bench_sim PRIVATE NOCTULE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
