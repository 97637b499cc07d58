# sandglass_module(NAME SOURCES a.cc ... [TESTS a.test.cc ...] [LINKS lib ...])
# A module is one folder under src/sandglass: a static library sandglass_NAME and, beside the code, its unit tests,
# gathered into one doctest program NAME_test that ctest runs.
function(sandglass_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;TESTS;LINKS" ${ARGN})
  add_library(sandglass_${name} STATIC ${ARG_SOURCES})
  target_include_directories(sandglass_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(sandglass_${name} PUBLIC ${ARG_LINKS})
  if(ARG_TESTS)
    add_executable(${name}_test ${ARG_TESTS} ${PROJECT_SOURCE_DIR}/tests/doctest_main.cc)
    target_link_libraries(${name}_test PRIVATE sandglass_${name} doctest::doctest rapidcheck)
    add_test(NAME unit.${name} COMMAND ${name}_test)
  endif()
endfunction()
