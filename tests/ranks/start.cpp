// The tests of runs on several ranks: every rank runs them all, started by mpirun.
#define DOCTEST_CONFIG_IMPLEMENT
#include "engine/ranks.hpp"

#include <doctest/doctest.h>

int main(int argc, char** argv) {
    const bris::RanksOfProgram ranks;
    doctest::Context context(argc, argv);
    if (!bris::Ranks::is_first()) context.setOption("no-intro", true);
    const int result = context.run();
    return result;
}
