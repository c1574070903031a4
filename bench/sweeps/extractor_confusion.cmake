noctule_sweep(extractor_confusion ROOMS sensors)
target_include_directories(sweep_extractor_confusion PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the scene generator
