#pragma once

namespace bris {

/// Largest value of an evenly sampled quantity, from the parabola through the largest sample and
/// its neighbours. Third order in the sampling interval for a smooth quantity.
class Peak {
public:
    void add(double x) {
        if (count_ == 0 || x > middle_) {
            before_ = count_ == 0 ? x : previous_;
            middle_ = after_ = x;
            at_ = count_;
            fresh_ = true;
        } else if (fresh_) {
            after_ = x;
            fresh_ = false;
        }
        previous_ = x;
        ++count_;
    }
    double value() const {
        return bend() < 0 ? middle_ - slope() * slope() / (8 * bend()) : middle_;
    }
    /// Time of the peak in sampling intervals after the first sample.
    double time_index() const { return at_ + (bend() < 0 ? -0.5 * slope() / bend() : 0); }

private:
    double bend() const { return before_ - 2 * middle_ + after_; }
    double slope() const { return after_ - before_; }

    double before_ = 0, middle_ = 0, after_ = 0, previous_ = 0, at_ = 0, count_ = 0;
    bool fresh_ = false;
};

} // namespace bris
