# noctule-evaluate and noctule-calibrate as their users meet them.
add_executable(evaluate_test ${CMAKE_CURRENT_LIST_DIR}/evaluate_test.cpp)
target_link_libraries(evaluate_test PRIVATE noctule_warnings GTest::gtest_main)
target_include_directories(evaluate_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(evaluate_test PRIVATE NOCTULE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                 NOCTULE_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
add_dependencies(evaluate_test noctule-evaluate noctule-calibrate noctule-pipeline)
gtest_discover_tests(evaluate_test TEST_PREFIX system. PROPERTIES LABELS system TIMEOUT 120)

# Against the Python package evo, where a Python that has it is named (NOCTULE_EVO_PYTHON) or is the system's.
add_test(NAME system.evaluate_agrees_with_evo COMMAND ${CMAKE_CURRENT_LIST_DIR}/evaluate_evo.sh
                                                      $<TARGET_FILE:noctule-evaluate>)
set_tests_properties(system.evaluate_agrees_with_evo PROPERTIES LABELS system SKIP_RETURN_CODE 77 TIMEOUT 120)
