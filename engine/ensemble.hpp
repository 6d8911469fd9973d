#pragma once

#include <cstddef>
#include <functional>

namespace bris {

/// Runs `jobs` independent jobs, at most `at_once` at a time (0: as many as there are cores), each
/// on one thread. Jobs start in the order of their numbers. If a job throws, no further job starts,
/// the running jobs finish, and the error of the job with the lowest number is thrown, so that the
/// error does not depend on timing. Jobs must not share anything that one of them writes, including
/// files.
void run_ensemble(std::size_t jobs, unsigned at_once,
                  const std::function<void(std::size_t job)>& run);

} // namespace bris
