noctule_sweep(camera_false_positives ROOMS sensors datasets LINK opencv_core)
target_include_directories(sweep_camera_false_positives PRIVATE ${PROJECT_SOURCE_DIR}/test)  # the scene generator
