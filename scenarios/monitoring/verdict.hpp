#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace bris {

/// What the recording of a sensor says about the track beside it, from the least to the most
/// serious. Only `as_baseline` is an all-clear; it needs a recording in which a change would be
/// seen. `no_train`: nothing passed, as other sensors show. `quieter_or_no_train`: no other sensor
/// shows which of both. `time_unknown`: nothing says when it was recorded. `moved`: the sensor was
/// turned or mounted anew, which cannot be told apart.
enum class Verdict {
    no_train,
    as_baseline,
    quieter_or_no_train,
    not_enough_data,
    time_unknown,
    moved,
    another_motion,
    another_spectrum,
    quieter,
    louder,
    drifts
};
inline constexpr std::size_t verdicts = 11;

/// "as the baseline", "louder", "not enough data" ...
const char* text_of(Verdict verdict);
/// Whether the vibration has changed: it is an alarm.
bool is_change(Verdict verdict);
/// Whether nothing was found out.
bool is_not_judged(Verdict verdict);

/// Numbers of passages by verdict.
class PassageTally {
public:
    void add(Verdict verdict, int count = 1);
    std::size_t all() const;
    std::size_t changed() const;
    std::size_t not_judged_count() const;
    std::size_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }
    /// "as the baseline in 15 of 25 passages; 10 not judged: no train".
    std::string sentence() const;
    /// "10 not judged: no train"; empty: all were judged.
    std::string not_judged() const;

private:
    std::array<std::size_t, verdicts> counts_{};
};

} // namespace bris
