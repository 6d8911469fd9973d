#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

// Damaged files make the HDF5 library ask for any size, which is to be refused as without a
// sanitizer; and it then loses a few bytes of its own.
#define BRIS_SEEN_BY_SANITIZERS extern "C" __attribute__((visibility("default"))) const char*
#ifdef __SANITIZE_ADDRESS__
BRIS_SEEN_BY_SANITIZERS __asan_default_options() { return "allocator_may_return_null=1"; }
BRIS_SEEN_BY_SANITIZERS __lsan_default_suppressions() { return "leak:libhdf5"; }
#endif
#ifdef __SANITIZE_THREAD__
BRIS_SEEN_BY_SANITIZERS __tsan_default_options() { return "allocator_may_return_null=1"; }
// OpenVDB copies trees with oneTBB, whose library is not instrumented, so that its order is not
// seen
BRIS_SEEN_BY_SANITIZERS __tsan_default_suppressions() { return "race:tbb::detail"; }
#endif
