# noctule-experiment as its users meet it, on one machine and on several.
add_executable(experiment_test ${CMAKE_CURRENT_LIST_DIR}/experiment_run_test.cpp)
target_link_libraries(experiment_test PRIVATE noctule_warnings GTest::gtest_main)
target_include_directories(experiment_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(experiment_test PRIVATE NOCTULE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                   NOCTULE_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
add_dependencies(experiment_test noctule-experiment)
gtest_discover_tests(experiment_test TEST_PREFIX system. PROPERTIES LABELS system TIMEOUT 120)
foreach(how slurm parallel)
  add_test(NAME system.experiment_shards_${how}
           COMMAND ${CMAKE_CURRENT_LIST_DIR}/experiment_shards.sh ${how} $<TARGET_FILE:noctule-experiment>
                   ${PROJECT_SOURCE_DIR})
  set_tests_properties(system.experiment_shards_${how} PROPERTIES LABELS system SKIP_RETURN_CODE 77 TIMEOUT 300)
endforeach()

# Neither README nor a page of docs/results quotes a figure that is not in the tables beside it.
file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/results/*.md)
add_test(NAME rules.results_pages COMMAND noctule-experiment pages --check ${PROJECT_SOURCE_DIR}/README.md ${pages})
set_tests_properties(rules.results_pages PROPERTIES LABELS rules)
