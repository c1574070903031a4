noctule_sweep(camera_detection ROOMS sensors LINK opencv_core)
target_include_directories(sweep_camera_detection PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the scene generator
