add_executable(pipeline_test ${CMAKE_CURRENT_LIST_DIR}/pipeline_run_test.cpp
                             ${CMAKE_CURRENT_LIST_DIR}/pipeline_processes_test.cpp
                             ${CMAKE_CURRENT_LIST_DIR}/pipeline_recorded_test.cpp
                             ${CMAKE_CURRENT_LIST_DIR}/pipeline_refusals_test.cpp)
target_link_libraries(pipeline_test PRIVATE noctule::bus noctule::convert noctule::core noctule::eval noctule::types
                                            noctule_warnings GTest::gtest_main)
target_include_directories(pipeline_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(pipeline_test PRIVATE NOCTULE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                 NOCTULE_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
foreach(app pipeline sim player ultrasonic camera slam mapper)
  add_dependencies(pipeline_test noctule-${app})
endforeach()
gtest_discover_tests(pipeline_test TEST_PREFIX system. PROPERTIES LABELS system TIMEOUT 300)
