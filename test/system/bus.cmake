add_executable(bus_publisher ${CMAKE_CURRENT_LIST_DIR}/bus_publisher.cpp)
target_link_libraries(bus_publisher PRIVATE noctule::bus noctule::convert noctule_warnings)
target_include_directories(bus_publisher PRIVATE ${PROJECT_SOURCE_DIR}/test)

add_executable(bus_udpm_test ${CMAKE_CURRENT_LIST_DIR}/bus_udpm_test.cpp)
target_link_libraries(bus_udpm_test PRIVATE noctule::bus noctule::types noctule_warnings GTest::gtest_main)
target_include_directories(bus_udpm_test PRIVATE ${PROJECT_SOURCE_DIR}/test)
gtest_discover_tests(bus_udpm_test TEST_PREFIX system. PROPERTIES LABELS system)

foreach(sender every_type pipeline)
  add_test(NAME system.spy_${sender} COMMAND ${CMAKE_CURRENT_LIST_DIR}/spy.sh ${PROJECT_SOURCE_DIR}
                                             ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${sender})
endforeach()
add_test(NAME system.bus_no_route COMMAND ${CMAKE_CURRENT_LIST_DIR}/bus_no_route.sh ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
add_test(NAME system.bus_unlisted_type COMMAND ${CMAKE_CURRENT_LIST_DIR}/bus_unlisted_type.sh ${PROJECT_SOURCE_DIR}
                                               ${CMAKE_COMMAND})
set_tests_properties(system.spy_every_type system.spy_pipeline system.bus_no_route system.bus_unlisted_type
                     PROPERTIES LABELS system SKIP_RETURN_CODE 77 TIMEOUT 300)

find_program(NOCTULE_PYTHON python3)
mark_as_advanced(NOCTULE_PYTHON)
if(NOCTULE_PYTHON)
  add_test(NAME system.bus_python COMMAND ${NOCTULE_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/bus_python.py
                                          ${PROJECT_BINARY_DIR}/python
                                          ${PROJECT_SOURCE_DIR}/test/golden/wire_format.lcmlog)
  set_tests_properties(system.bus_python PROPERTIES LABELS system)
endif()
