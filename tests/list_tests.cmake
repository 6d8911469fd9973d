# Run by ctest: registers the test cases of EXECUTABLE, each labelled with its suite. One listing gives both, whereas
# doctest's own script starts the executable once for every test to learn its suite. A case that is marked `* doctest::skip()`
# takes long: it is labelled slow, too.
execute_process(COMMAND ${EXECUTABLE} --reporters=xml --list-test-cases --no-skip OUTPUT_VARIABLE listing RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${EXECUTABLE} --list-test-cases: expected exit code 0, found ${result}")
endif()
string(REPLACE ";" "\\;" listing "${listing}")
string(REGEX MATCHALL "<TestCase [^\n]*" cases "${listing}")
foreach(case IN LISTS cases)
  string(REGEX REPLACE ".* name=\"([^\"]*)\".*" "\\1" name "${case}")
  string(REGEX REPLACE ".* testsuite=\"([^\"]*)\".*" "\\1" suite "${case}")
  string(REPLACE "&quot;" "\"" name "${name}")
  string(REPLACE "&lt;" "<" name "${name}")
  string(REPLACE "&gt;" ">" name "${name}")
  string(REPLACE "&amp;" "&" name "${name}")
  string(REPLACE "," "\\," filter "${name}")   # doctest separates filters by commas
  add_test("${name}" ${EXECUTABLE} "--test-case=${filter}" --no-skip)
  set(seconds ${SECONDS})
  if(suite STREQUAL "slow")
    set(seconds 10800)
  endif()
  set(labels "${suite}")
  if(case MATCHES "skipped=\"true\"")
    list(APPEND labels slow)
  endif()
  set_tests_properties("${name}" PROPERTIES TIMEOUT ${seconds} LABELS "${labels}"
    ENVIRONMENT XDG_CACHE_HOME=/dev/null    # no test takes a bed that the user has kept
    SKIP_REGULAR_EXPRESSION "skipped: no data")
endforeach()
