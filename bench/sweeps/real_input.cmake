noctule_sweep(real_input ROOMS modules)
target_compile_definitions(sweep_real_input PRIVATE NOCTULE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
