# cmake -D BRIS_SOURCE=... -D BRIS_FILE=... -D BRIS_VERSION=... -D BRIS_ARCH=... -D BRIS_LIBRARIES=... -P build_facts.cmake
# writes the one source file that knows the commit; a file that would be the same is left as it is.
set(BRIS_COMMIT "")
if(EXISTS "${BRIS_SOURCE}/.git")         # or git would find the repository of a folder around an unpacked archive
  execute_process(COMMAND git --no-optional-locks -C "${BRIS_SOURCE}" describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE BRIS_COMMIT ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(NOT BRIS_COMMIT)
  set(BRIS_COMMIT "unknown")
endif()
configure_file("${BRIS_SOURCE}/engine/build_facts.cpp.in" "${BRIS_FILE}" @ONLY)
