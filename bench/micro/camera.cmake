noctule_bench(camera ROOMS sensors LINK opencv_core opencv_features2d opencv_aruco)
target_include_directories(bench_camera PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the scene generator
