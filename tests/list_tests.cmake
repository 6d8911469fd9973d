# Run by ctest: registers the test cases of EXECUTABLE, each labelled with its suite. One listing gives both, whereas
# doctest's own script starts the executable once for every test to learn its suite.
execute_process(COMMAND ${EXECUTABLE} --reporters=xml --list-test-cases OUTPUT_VARIABLE listing RESULT_VARIABLE result)
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
  add_test("${name}" ${EXECUTABLE} "--test-case=${filter}")
  set_tests_properties("${name}" PROPERTIES TIMEOUT ${SECONDS} LABELS "${suite}")
endforeach()
