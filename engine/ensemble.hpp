#pragma once

#include <cstddef>
#include <functional>

namespace bris {

/// Runs `jobs` independent jobs (worlds, each with one thread of its own), at most `at_once` at a
/// time (0: as many as there are cores); they start in the order of their numbers. When one throws,
/// no further job starts, those that run are finished, and the error of the lowest number is
/// thrown: the same one however the jobs fell in time. Jobs share nothing that one of them writes,
/// files included.
void run_ensemble(std::size_t jobs, unsigned at_once,
                  const std::function<void(std::size_t job)>& run);

} // namespace bris
