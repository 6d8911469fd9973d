#pragma once

#include "scenarios/stream/record_stream.hpp"

#include <cstdint>
#include <deque>
#include <vector>

namespace bris {

/// Decides which records of a test machine continue the test. One that is further ahead than the
/// machine travels is held until others agree with it: `agreeing` records, each with a larger
/// strain and a later time than the one before, near each other, and none of the test so far in
/// between; copies are one record. Beyond `largest_jump`, moreover, the machine must be able to
/// have travelled so far in the time since its last record: by at most `faster` times its own rate,
/// the median of its last steps. Times are the machine's t, or else those of arrival; without
/// either, where its clock was set back, or before it has a rate, agreement is enough. Pure
/// function of the records.
class MachineTrack {
public:
    /// Axial strain by which it is always held.
    static constexpr double largest_jump = 2e-3;
    static constexpr double faster = 5;
    static constexpr std::size_t agreeing = 3;

    struct Decision {
        std::vector<StreamRecord> used = {}; ///< of the test, in order
        bool is_ahead = false;               ///< the record is held, or left out
        bool is_gap = false;                 ///< those used were held: records before are lost
    };
    /// `record`: with a finite axial_strain.
    Decision take(const StreamRecord& record);
    /// Axial strain that was reached; 0: no record so far.
    double reached() const { return reached_; }

private:
    double time_of(const StreamRecord& record);
    bool is_possible(double strain, double time) const;
    double allowed(double time) const;
    void advance_to(double strain, double time);

    struct Step {
        double strain, seconds; // NaN: unknown
    };
    std::deque<Step> steps_; // the last ones
    std::vector<StreamRecord> held_;
    double reached_ = 0, time_ = no_arrival;
    bool begun_ = false;
    bool by_t_ = false; // its records have t
};

} // namespace bris
